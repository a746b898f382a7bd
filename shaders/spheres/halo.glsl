// Darkness behind the silhouettes of spheres, which tells what is before what: the more, the farther behind (Tarini,
// Cignoni & Montani 2006, "Ambient Occlusion and Edge Cueing to Enhance Real Time Molecular Visualization"), found in the
// picture's depths (Luft, Colditz & Deussen 2006, "Image Enhancement by Unsharp Masking the Depth Buffer"): not by a
// blurred depth, but by the place around that darkens most, so that it does not hang on how much of it there is.
uniform float halo_strength;
uniform float halo_radius_px;
uniform float halo_depth_m;
uniform int halo_step_px;

float light_past_halos() {
    if (halo_strength <= 0.0) return 1.0;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float z_m = near_plane_m / fragment_depth;
    // Beyond this no one looks for a halo, and pictures of any size end.
    const int most_reach = 128;
    int reach = min(int(halo_radius_px), most_reach) / halo_step_px * halo_step_px;
    ivec2 first = max(-pixel, ivec2(-reach)), last = min(ivec2(picture_px) - 1 - pixel, ivec2(reach));
    float most = 0.0;
    for (int y = -reach; y <= reach; y += halo_step_px) {
        for (int x = -reach; x <= reach; x += halo_step_px) {
            if (any(lessThan(ivec2(x, y), first)) || any(greaterThan(ivec2(x, y), last))) continue;
            float near_share = 1.0 - length(vec2(x, y)) / halo_radius_px;
            if (near_share <= most) continue;
            float share = texelFetch(seen_depth, pixel + ivec2(x, y), 0).r;
            if (share <= fragment_depth) continue;
            most = max(most, near_share * min((z_m - near_plane_m / share) / halo_depth_m, 1.0));
        }
    }
    return 1.0 - halo_strength * most;
}
