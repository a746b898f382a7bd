#!/usr/bin/env bash
# Renders each technique of surfaces beside its reference, and writes a page with the difference and the times.
#
# Usage: samples/surfaces/gallery.sh [matchlight] [folder]   (build/release/matchlight and out/surfaces unless given)
set -euo pipefail
cd "$(dirname "$0")/../.."
matchlight=${1:-build/release/matchlight}
folder=${2:-out/surfaces}
pictures=$PWD/samples/surfaces
mkdir -p "$folder"

# The stones as a truly displaced surface: a corner a texel of a metre, 0.05 m high, by the formula that the height map
# was drawn by. OBJ's y points up.
awk 'function frac(x) { return x - floor(x) }
     function floor(x) { f = int(x); return x < f ? f - 1 : f }
     function abs(x) { return x < 0 ? -x : x }
     function rise(d) { d = d / 0.25; if (d < 0) d = 0; if (d > 1) d = 1; return d * d * (3 - 2 * d) }
     function height(u, v,   row, column, across, h) {
         row = 8 * v; column = 5 * u + (floor(row) % 2 == 0 ? 0 : 0.5)
         across = 2 * abs(frac(column) - 0.5) * 8 / 5
         h = 0.05 + 0.9 * rise((8 / 5 - across) / 2) * rise(0.5 - abs(frac(row) - 0.5))
         return h < 0 ? 0 : h > 1 ? 1 : h
     }
     BEGIN {
         n = 256
         for (j = 0; j <= n; ++j)
             for (i = 0; i <= n; ++i) {
                 u = i / n; v = j / n
                 printf "v %.6f %.6f %.6f\nvt %.6f %.6f\n", u - 0.5, -0.05 * (1 - height(u, v)), v - 0.5, u, 1 - v
             }
         for (j = 0; j < n; ++j)
             for (i = 1; i <= n; ++i) {
                 a = j * (n + 1) + i; b = a + n + 1
                 printf "f %d/%d %d/%d %d/%d\nf %d/%d %d/%d %d/%d\n", a, a, b, b, b + 1, b + 1, a, a, b + 1, b + 1, a + 1, a + 1
             }
     }' > "$folder/displaced.obj"

# scene FILE OBJECT ORBIT: a still of one object in the studio's light.
scene() {
    cat > "$folder/$1.toml" <<END
[camera]
width = 480
height = 360
frames = 1
vertical_fov_deg = 30
exposure_ev = -1.5
orbit = {$3}
[light]
probe = "$PWD/samples/study/studio.exr"
[background]
color = [0.2, 0.2, 0.2]
[quality]
reflections = "environment"
bounce = false
[[object]]
casts_shadow = false
$2
END
}

# picture NAME [LEVEL]: renders it.
picture() {
    "$matchlight" render "$folder/$1.toml" -o "$folder/$1.png" --level "${2:-preview}" --overwrite -q
}
# drawn NAME: milliseconds of drawing its surfaces once.
drawn() {
    "$matchlight" render "$folder/$1.toml" --explain 0 --level preview | awk '$1 == "surface" && $2 == "drawn" { print $6 }'
}
# milliseconds NAME: the middle one of five.
milliseconds() {
    for _ in 1 2 3 4 5; do drawn "$1"; done | sort -n | sed -n 3p
}
# added NAME...: to each the time that it adds to the flat stones, over what relief adds. All in turns, so that what else
# the machine does slows them alike; the middle one of nine rounds.
added() {
    local name
    for _ in 1 2 3 4 5 6 7 8 9; do
        for name in flat relief "$@"; do echo "$name $(drawn "$name")"; done
    done | sort -k1,1 -k2,2n | awk -v names="$*" '
        { time[$1, ++count[$1]] = $2 }
        function middle(name) { return time[name, 5] }
        END {
            n = split(names, name, " ")
            for (i = 1; i <= n; ++i)
                printf "%-24s adds %.2f of what relief adds\n", name[i],
                       (middle(name[i]) - middle("flat")) / (middle("relief") - middle("flat"))
        }'
}

page=$folder/index.html
cat > "$page" <<END
<!DOCTYPE html><meta charset="utf-8"><title>Surfaces</title>
<style>body{font:16px sans-serif;margin:2em}td,th{padding:.4em;text-align:left;vertical-align:top}img{width:360px}</style>
<h1>Surfaces</h1><table><tr><th>technique<th>picture<th>reference<th>FLIP<th>time
END

# row NAME REFERENCE SOURCE [SETTINGS]: the two pictures, how far apart they are, how much longer the first took than a
# reference of ours.
row() {
    local flip time reference_time ratio=
    flip=$("$matchlight" compare "$folder/$2.png" "$folder/$1.png" 2>/dev/null | awk '$1 == "mean" { print $2 }')
    if [ -e "$folder/$2.toml" ]; then
        time=$(milliseconds "$1") reference_time=$(milliseconds "$2")
        ratio=$(awk -v a="${time:-0}" -v b="${reference_time:-0}" 'BEGIN { if (b > 0) printf "%.2f of the reference", a / b }')
    fi
    echo "<tr><td><b>$1</b><br>$3${4:+<br><code>$4</code>}<td><img src=\"$1.png\"><td><img src=\"$2.png\"><br>$2<td>$flip<td>$ratio" >> "$page"
    printf '%-24s FLIP %-8s %s\n' "$1" "$flip" "${ratio:+time $ratio}"
}

near='target = [0, 0, 0], radius = 0.5, elevation_deg = 50, from_deg = -90'
whole='target = [0, 0, 0], radius = 2.4, elevation_deg = 35, from_deg = -90'
flat='target = [0, 0, 0], radius = 1.2, elevation_deg = 8, from_deg = -90'
stones="texture = \"$pictures/stones_color.png\", roughness = 0.6"
heights="height_map = \"$pictures/stones.png\", height = 0.05"

scene displaced "model = \"displaced.obj\"
material = {$stones}" "$near"
picture displaced
scene normal_map "shape = \"plane\"
material = {$stones, normal_map = \"$pictures/stones_normals.png\"}" "$near"
picture normal_map
row normal_map displaced "Cohen, Olano & Manocha 1998, Appearance-Preserving Simplification"
while IFS='|' read -r name settings source; do
    scene "$name" "shape = \"plane\"
material = {$stones, $heights, $settings}" "$near"
    picture "$name"
    row "$name" displaced "$source"
done <<'END'
bump|relief = "bump"|Blinn 1978, Simulation of Wrinkled Surfaces
parallax|relief = "parallax"|Kaneko et al. 2001, Detailed Shape Representation with Parallax Mapping; Welsh 2004
occlusion|relief = "occlusion", relief_steps = 32|Tatarchuk 2006, Dynamic Parallax Occlusion Mapping
relief|relief = "relief", relief_steps = 64|Policarpo, Oliveira & Comba 2005, Real-Time Relief Mapping
cone_step|relief = "cone_step", relief_steps = 12|Dummer 2006, Cone Step Mapping
sphere_tracing|relief = "sphere_tracing", relief_steps = 16|Donnelly 2005, Per-Pixel Displacement Mapping with Distance Functions
END
scene flat "shape = \"plane\"
material = {$stones}" "$near"
adding=$(added occlusion cone_step sphere_tracing)
echo "$adding"
echo "<tr><td colspan=5><pre>$adding</pre>" >> "$page"

# Patterns: once as they are, once by many unfiltered samples a pixel.
while IFS='|' read -r name settings orbit source; do
    for filtered in true false; do
        file=$name
        if [ "$filtered" = false ]; then file=${name}_samples; fi
        scene "$file" "${settings/@/$'\n'}, filtered = $filtered}}" "${!orbit}"
        if [ "$filtered" = true ]; then picture "$file"; else picture "$file" reference; fi
    done
    row "$name" "${name}_samples" "$source"
done <<'END'
square_wave|shape = "plane"@material = {pattern = {kind = "square_wave", frequency = 60|flat|Apodaca & Gritz 1999, Advanced RenderMan
checker|shape = "plane"@material = {pattern = {kind = "checker", frequency = 40|flat|the same
noise|shape = "sphere"@material = {pattern = {kind = "noise", frequency = 12, color = [1, 0.9, 0.7], second_color = [0.1, 0.15, 0.3]|whole|Perlin 2002, Improving Noise; Norton, Rockwood & Skolmoski 1982, Clamping
wood|shape = "box"@material = {pattern = {kind = "wood", frequency = 10, turbulence = 0.5, direction = [1, 0.1, 0.05], color = [0.6, 0.35, 0.16], second_color = [0.3, 0.14, 0.05]|whole|Ebert et al. 2003, Texturing and Modeling
marble|shape = "sphere"@material = {pattern = {kind = "marble", frequency = 5, turbulence = 1.5, color = [0.15, 0.17, 0.2], second_color = [0.9, 0.88, 0.85]|whole|Perlin 1985, An Image Synthesizer
END

# Samplers against many samples of the picture's own texels; layers against one picture of the same sum.
scene texels "shape = \"plane\"
material = {texture = \"$pictures/cells.png\", uv_scale = 12, texture_filter = \"nearest\"}" "$flat"
picture texels reference
while IFS='|' read -r name settings; do
    scene "$name" "shape = \"plane\"
material = {texture = \"$pictures/cells.png\", uv_scale = 12, $settings}" "$flat"
    picture "$name"
    row "$name" texels "Williams 1983, Pyramidal Parametrics; Heckbert 1986, Survey of Texture Mapping"
done <<'END'
nearest|texture_filter = "nearest"
linear|texture_filter = "linear"
mipmapped|texture_filter = "mipmapped"
anisotropic|texture_filter = "mipmapped", anisotropy = 16
END

scene layers "shape = \"plane\"
material = {$stones, layers = [{texture = \"$pictures/moss.png\", alpha = 0.8}, {texture = \"$pictures/cells.png\", alpha = 0.2}], $heights}" "$near"
picture layers
echo "<tr><td><b>layers</b><br>MT(n) = T(n)·a + MT(n−1)·(1−a)<td><img src=\"layers.png\"><td>its numbers: tests/gpu/surface_pattern_test.cpp<td><td>" >> "$page"

# ball NAME SHADING [EFFECTS]: the ball of classic_reference.py, beside what that draws in double precision.
ball() {
    cat > "$folder/$1.toml" <<END
[camera]
width = 240
height = 180
frames = 1
vertical_fov_deg = 30
keys = [{frame = 0, eye = [0, -2.2, 0], target = [0, 0, 0]}]
[background]
color = [0.2, 0.2, 0.2]
[[light]]
type = "directional"
direction = [0.5, 0.7, -0.6]
intensity = 3
[[object]]
shape = "sphere"
casts_shadow = false
material = {shading = "$2", diffuse = [0.7, 0.25, 0.15], specular = [0.6, 0.6, 0.6], shininess = 40, tones = 4}
[effects]
${3:-}
END
    picture "$1"
    samples/surfaces/classic_reference.py "$1" "$folder/$1_in_doubles.png"
    row "$1" "$1_in_doubles" "$4" "${3:-shading = \"$2\"}"
}
ball phong phong "" "Phong 1975, Illumination for Computer Generated Pictures"
ball blinn_phong blinn_phong "" "Blinn 1977, Models of Light Reflection for Computer Synthesized Pictures"
ball cartoon cartoon "" "Lake et al. 2000, Stylized Rendering Techniques for Scalable Real-Time 3D Animation"
ball gooch gooch "" "Gooch et al. 1998, A Non-Photorealistic Lighting Model for Automatic Technical Illustration"
ball depth_cue phong "depth_cue = {near = 1.6, far = 1.9, color = [0.2, 0.2, 0.2]}" "linear fog, as PHIGS and OpenGL have it"
while IFS='|' read -r name settings source; do
    ball "$name" phong "color_transform = {$settings}" "$source"
done <<'END'
brightness|brightness = 0.15|
contrast|contrast = 1.6|
fade|fade = 0.5, fade_color = [0.8, 0.85, 0.9]|
grey_hsv|grey = "hsv"|Smith 1978, Color Gamut Transform Pairs
grey_average|grey = "average"|
grey_yiq|grey = "yiq"|NTSC 1953
tinted_grey|grey = "yiq", tint = [1, 0.82, 0.6]|
hue_hsv|hue_deg = 120|Smith 1978, Color Gamut Transform Pairs
hue_yiq|model = "yiq", hue_deg = 120|NTSC 1953
matrix|red_from = [0, 0, 1], blue_from = [1, 0, 0]|
END

# What else is done to colours, beside the same as it was.
printf 'LUT_3D_SIZE 2\n%s\n' '0.05 0 0.15
1 0.3 0
0.1 0.6 0.3
1 0.9 0.2
0 0.1 0.6
0.8 0.2 0.7
0.2 0.7 0.9
1 0.95 0.85' > "$folder/warm.cube"
colored='shape = "teapot"
material = {pattern = {kind = "marble", frequency = 4, color = [0.7, 0.2, 0.1], second_color = [0.15, 0.4, 0.7]}}'
scene colors "$colored" "$whole"
picture colors
while IFS='|' read -r name settings source; do
    scene "$name" "$colored
[effects]
$settings" "$whole"
    picture "$name"
    echo "<tr><td><b>$name</b><br><code>$settings</code><br>$source<td><img src=\"$name.png\"><td><img src=\"colors.png\"><br>untouched; its numbers: tests/gpu/color_transform_test.cpp<td><td>" >> "$page"
done <<END
table|color_transform = {table = "warm.cube"}|
mask|color_transform = {grey = "yiq", mask = "$pictures/cells.png"}|
repeated_blur|repeated_blur = {passes = 4, radius_px = 2}|Wells 1986, Efficient Synthesis of Gaussian Filters by Cascaded Uniform Filters
END
echo "</table>" >> "$page"
echo "The page is $page"
