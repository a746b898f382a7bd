// Cases of depth of field, for every method: lenses and focus beyond all reason, highlights, and light that must not
// leak.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "render/virtual_layer.h"
#include "report/lens_cards.h"
#include "report/stability_cases.h"
#include "scene/depth_of_field_levels.h"

namespace matchlight {
namespace {

constexpr int width = 64, height = 48;
/// The layer is drawn in half floats, and one is rounded twice: by what draws it and by what blends it.
constexpr double half_step = 0x1p-11;
constexpr double near_half = 2 * half_step;

/// Four layer pixels along a plate pixel's side, which share its edges.
Quality card_quality() {
    Quality quality = quality_of(QualityLevel::draft);
    quality.supersampling = 4;
    quality.depth_of_field = QualityLevel::final_;
    return quality;
}

DepthOfFieldSettings settings_of(DepthOfFieldLevel level) {
    DepthOfFieldSettings settings;
    settings.level = level;
    settings.lens_samples = 32;
    return settings;
}

/// Those that keep light by what they are: the accumulated pictures, and the gather's normalised discs. The study's and
/// the older methods do not claim it; what they keep is shown.
bool promises_energy(DepthOfFieldLevel level) {
    return level == DepthOfFieldLevel::gather || level == DepthOfFieldLevel::lens_samples;
}

constexpr Bound kept{0.999, 1.001};

double sum_of(const ImageF& picture, int channel) {
    double sum = 0;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) sum += picture.at(x, y, channel);
    }
    return sum;
}

/// NaN where any sample is none: no bound holds it.
double largest_of(const ImageF& picture) {
    double largest = 0;
    for (const float value : picture.samples()) {
        if (!std::isfinite(value)) return std::numeric_limits<double>::quiet_NaN();
        largest = std::max(largest, std::abs(static_cast<double>(value)));
    }
    return largest;
}

ImageF drawn(const ThinLensView& view, DepthOfFieldLevel level) {
    return composited_cards(*current_gl_context(), lens_card_shot(view, settings_of(level)), card_quality());
}
ImageF drawn_sharp(const ThinLensView& view) {
    return composited_cards(*current_gl_context(), lens_card_shot(view, std::nullopt), card_quality());
}

/// Sides along x and y of a rectangle about the frame's middle, whose edges fall on layer pixels'.
LensCard middle_card(int side_px, int frame_width, int frame_height, double depth_m, double light) {
    const int first_column = (frame_width - side_px) / 2, first_row = (frame_height - side_px) / 2;
    const double left = first_column - 0.5, top = first_row - 0.5;
    return {.left_px = left,
            .top_px = top,
            .right_px = left + side_px,
            .bottom_px = top + side_px,
            .depth_m = depth_m,
            .light = {light, light, light, 1}};
}

LensCard middle_card(int side_px, double depth_m, double light) {
    return middle_card(side_px, width, height, depth_m, light);
}

struct LensCase {
    std::string name;
    ThinLensView view;
    bool stays_in_frame = true;  // all of the light
};

std::vector<LensCase> lens_cases() {
    const auto view_of = [](const Focus& focus, const LensCard& card) {
        return ThinLensView{.width = width, .height = height, .focus = focus, .bokeh = {}, .cards = {card}};
    };
    constexpr double infinity = std::numeric_limits<double>::infinity();
    ThinLens fast{.focal_length_m = 0.05, .f_number = 0.5, .focus_distance_m = 1, .image_width_px = width};
    ThinLens slow = fast;
    slow.f_number = 64;
    return {{"a circle ten times as wide as the frame",
             view_of({.coc_scale_px_m = 10 * width, .focus_distance_m = 0.5}, middle_card(9, 1e6, 1)), false},
            {"focus behind the object", view_of({.coc_scale_px_m = 6, .focus_distance_m = 3}, middle_card(9, 0.5, 1))},
            {"focus at infinity", view_of({.coc_scale_px_m = 6, .focus_distance_m = infinity}, middle_card(9, 0.5, 1))},
            {"f/0.5", view_of(focus_of(fast), middle_card(9, 0.6, 1))},
            {"f/64", view_of(focus_of(slow), middle_card(9, 0.6, 1))},
            {"an object at the near plane",
             view_of({.coc_scale_px_m = 2, .focus_distance_m = 1}, middle_card(9, 1.001 * near_plane_m, 1)), false},
            {"one pixel of 1e5", view_of({.coc_scale_px_m = 16, .focus_distance_m = 1}, middle_card(1, 2, 1e5))},
            {"one pixel of 1e9", view_of({.coc_scale_px_m = 16, .focus_distance_m = 1}, middle_card(1, 2, 1e9))},
            {"one pixel of 1e9 before the focus",
             view_of({.coc_scale_px_m = 8, .focus_distance_m = 1}, middle_card(1, 0.5, 1e9))}};
}

/// The largest light over the sharp picture's largest: a mean is never more.
StabilityCase lens_case(const std::string& effect, DepthOfFieldLevel level, const LensCase& tried) {
    StabilityCase made{.effect = effect,
                       .name = tried.name,
                       .measure = "largest light over the sharp picture's",
                       .bound = {tried.stays_in_frame ? 1e-9 : 0, 1 + near_half},
                       .energy = {},
                       .run = {}};
    if (tried.stays_in_frame && promises_energy(level)) made.energy = kept;
    made.run = [level, view = tried.view, stays = tried.stays_in_frame] {
        const ImageF sharp = drawn_sharp(view), blurred = drawn(view, level);
        StabilityOutcome outcome{.value = largest_of(blurred) / largest_of(sharp)};
        if (stays) outcome.energy_kept = sum_of(blurred, 0) / sum_of(sharp, 0);
        return outcome;
    };
    return made;
}

/// Cards whose circles lie on both sides of where the gather takes coarser texels, and in between: half a pixel to 64.
StabilityCase widths_case(const std::string& effect, DepthOfFieldLevel level, int side_px, double light) {
    return {.effect = effect,
            .name = fmt::format("{} px of {:g}, circles from 0.5 px to 64 px", side_px, light),
            .measure = "share of the light that is kept, where it is farthest from all",
            .bound = kept,
            .energy = {},
            .run = [level, side_px, light] {
                // Wide enough for the widest circle on the coarsest texels.
                constexpr int frame_px = 128;
                constexpr double scale_px_m = 200;
                double farthest = 1;
                for (const double coc_px : {0.5, 2.0, 7.0, 15.9, 16.1, 31.9, 32.1, 45.0, 63.9}) {
                    for (const double side : {-1.0, 1.0}) {
                        ThinLensView view{.width = frame_px,
                                          .height = frame_px,
                                          .focus = {.coc_scale_px_m = scale_px_m, .focus_distance_m = 1},
                                          .bokeh = {},
                                          .cards = {}};
                        view.cards = {
                            middle_card(side_px, frame_px, frame_px, 1 / (1 - side * coc_px / scale_px_m), light)};
                        const double share = sum_of(drawn(view, level), 0) / sum_of(drawn_sharp(view), 0);
                        if (!std::isfinite(share)) return StabilityOutcome{.value = share};
                        if (std::abs(share - 1) > std::abs(farthest - 1)) farthest = share;
                    }
                }
                return StabilityOutcome{.value = farthest};
            }};
}

/// Red light that lies more than `reach_px` outside of a card, as a share of the card's light.
double leaked_share(const ImageF& picture, const LensCard& card, double reach_px) {
    if (!std::isfinite(largest_of(picture))) return std::numeric_limits<double>::quiet_NaN();
    double leaked = 0;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            const double beside_x = std::max({card.left_px - (x + 0.5), (x - 0.5) - card.right_px, 0.0});
            const double beside_y = std::max({card.top_px - (y + 0.5), (y - 0.5) - card.bottom_px, 0.0});
            if (std::hypot(beside_x, beside_y) > reach_px)
                leaked = std::max(leaked, std::abs(static_cast<double>(picture.at(x, y, 0))));
        }
    }
    return leaked / card.light[0];
}

/// Of how much a method may leak: nothing but rounding where it promises to know what lies before what; else at most
/// the light itself.
double most_leaked(DepthOfFieldLevel level) {
    return promises_energy(level) ? near_half : 1;
}

void add_leak_cases(std::vector<StabilityCase>& cases, const std::string& effect, DepthOfFieldLevel level) {
    constexpr double bright = 100;
    const Focus focus{.coc_scale_px_m = 8, .focus_distance_m = 1};
    const auto green_card = [](int side_px, double depth_m) {
        LensCard card = middle_card(side_px, depth_m, 0.5);
        card.light = {0, 0.5, 0, 1};
        return card;
    };
    const auto leak_case = [&](const std::string& name, const LensCard& lamp, const LensCard& other) {
        // Half of the circle, the plate pixel that its rim lies in, and the texel of a method that draws wide discs on
        // coarser ones: no wider than a quarter of the disc.
        const double coc_px = std::abs(signed_coc_px(focus, lamp.depth_m)), reach_px = coc_px / 2 + 1 + coc_px / 4;
        cases.push_back({.effect = effect,
                         .name = name,
                         .measure = "share of a bright card's light where the lens sends none",
                         .bound = {0, most_leaked(level)},
                         .energy = {},
                         .run = [level, focus, lamp, other, reach_px] {
                             const ThinLensView view{
                                 .width = width, .height = height, .focus = focus, .bokeh = {}, .cards = {lamp, other}};
                             return StabilityOutcome{.value = leaked_share(drawn(view, level), lamp, reach_px)};
                         }});
    };
    LensCard sharp_lamp = middle_card(9, 1, bright), near_lamp = middle_card(9, 0.5, bright),
             far_lamp = middle_card(9, 4, bright);
    for (LensCard* lamp : {&sharp_lamp, &near_lamp, &far_lamp}) lamp->light = {bright, 0, 0, 1};
    leak_case("a bright card in focus before a blurred one", sharp_lamp, green_card(33, 4));
    leak_case("a bright blurred card before one in focus", near_lamp, green_card(33, 1));
    leak_case("a bright card far behind one in focus", far_lamp, green_card(5, 1));
}

/// What a black card out of focus takes of a bright plate behind it.
StabilityCase plate_case(const std::string& effect, DepthOfFieldLevel level) {
    constexpr double plate_light = 1e4;
    return {.effect = effect,
            .name = "a black blurred card before a plate of 1e4",
            .measure = "largest error of the plate's share that is left",
            // Along an edge a few of the 32 points of the lens come at once; who blurs otherwise leaves some share.
            .bound = {0, promises_energy(level) ? 3.0 / 32 : 1},
            .energy = {},
            .run = [level] {
                const ThinLensView view{.width = width,
                                        .height = height,
                                        .focus = {.coc_scale_px_m = 12, .focus_distance_m = 1},
                                        .bokeh = {},
                                        .cards = {middle_card(17, 0.5, 0)}};
                LensCardShot shot = lens_card_shot(view, settings_of(level));
                shot.scene.camera.emplace();
                shot.scene.background.color = {plate_light, plate_light, plate_light};
                const ImageD lens = thin_lens_light(view);
                const ImageF light = composited_frame(*current_gl_context(), shot, card_quality());
                double largest = 0;
                for (int y = 0; y < height; ++y) {
                    for (int x = 0; x < width; ++x) {
                        const double left = light.at(x, y, 0) / plate_light;
                        largest = std::max(largest, std::isfinite(left) ? std::abs(left - (1 - lens.at(x, y, 3)))
                                                                        : std::numeric_limits<double>::infinity());
                    }
                }
                return StabilityOutcome{.value = largest};
            }};
}

}  // namespace

std::vector<StabilityCase> depth_of_field_cases() {
    std::vector<StabilityCase> cases;
    for (std::size_t i = 0; i < depth_of_field_levels.size(); ++i) {
        const auto level = static_cast<DepthOfFieldLevel>(i);
        const std::string effect = fmt::format("depth of field, {}", depth_of_field_levels[i]);
        for (const LensCase& tried : lens_cases()) cases.push_back(lens_case(effect, level, tried));
        if (level == DepthOfFieldLevel::gather) {
            cases.push_back(widths_case(effect, level, 1, 1e5));
            cases.push_back(widths_case(effect, level, 9, 1));
        }
        add_leak_cases(cases, effect, level);
        cases.push_back(plate_case(effect, level));
    }
    return cases;
}

}  // namespace matchlight
