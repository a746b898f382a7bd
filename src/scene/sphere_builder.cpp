// Columns by name, radii, colours and opacities checked as they come in.
#include "scene/sphere_builder.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/memory.h"
#include "scene/color_map.h"
#include "scene/element_table.h"
#include "scene/scene_schema.h"

namespace matchlight {
namespace {

/// A colour channel that may be 0..1 as well as 0..255 until all were seen: bit 2^channel of the fourth byte says that
/// it was kept as a fraction.
constexpr std::size_t fraction_flags = 3;

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return text;
}

/// What a column is for by its name alone: names that simulation programs and Houdini use.
std::optional<SphereValue> usual_meaning(const std::string& column) {
    const std::string name = lower(column);
    static const std::vector<std::pair<std::string_view, SphereValue>> meanings = {
        {"radius", SphereValue::radius},   {"radii", SphereValue::radius},  {"pscale", SphereValue::radius},
        {"opacity", SphereValue::opacity}, {"alpha", SphereValue::opacity}, {"red", SphereValue::red},
        {"green", SphereValue::green},     {"blue", SphereValue::blue},     {"r", SphereValue::red},
        {"g", SphereValue::green},         {"b", SphereValue::blue},
    };
    for (const auto& [known, meaning] : meanings) {
        if (name == known) return meaning;
    }
    for (const std::string_view colors : {"color", "colors", "rgb", "cd"}) {
        if (!name.starts_with(colors)) continue;
        const std::string rest = name.substr(colors.size());
        if (rest == "_0") return SphereValue::red;
        if (rest == "_1") return SphereValue::green;
        if (rest == "_2") return SphereValue::blue;
    }
    return std::nullopt;
}

bool is_somewhere(const Sphere& sphere) {
    return std::ranges::all_of(sphere.centre_m, [](float coordinate) { return std::isfinite(coordinate); });
}

constexpr double most_float = std::numeric_limits<float>::max();

}  // namespace

SphereBuilder::SphereBuilder(std::filesystem::path path, const SphereSettings& settings, Warnings& warnings)
    : path_(std::move(path)), settings_(settings), warnings_(warnings) {}

bool SphereBuilder::wanted_by_user(const std::string& column, SphereValue value) const {
    switch (value) {
        case SphereValue::radius:
            return column == settings_.radius_column;
        case SphereValue::scalar:
            return column == settings_.color_column;
        case SphereValue::opacity:
            return column == settings_.opacity_column;
        default:
            return false;
    }
}

SphereValues SphereBuilder::claim(const std::string& column, ColumnKind kind) {
    columns_.push_back(column);
    SphereValues wanted;
    const auto want = [&](SphereValue value) { wanted.set(static_cast<std::size_t>(value)); };
    for (const SphereValue value : {SphereValue::radius, SphereValue::scalar, SphereValue::opacity}) {
        if (wanted_by_user(column, value)) want(value);
    }
    if (const auto meaning = usual_meaning(column)) {
        const bool chosen_otherwise =
            (*meaning == SphereValue::radius && (settings_.radius || !settings_.radius_column.empty())) ||
            (*meaning == SphereValue::opacity && !settings_.opacity_column.empty()) ||
            (*meaning >= SphereValue::red && !settings_.color_column.empty());
        // The first of two such columns holds.
        if (!chosen_otherwise && !claimed(*meaning)) want(*meaning);
    }
    claimed_ |= wanted;
    if (kind == ColumnKind::byte) {
        if (wanted[static_cast<std::size_t>(SphereValue::opacity)]) opacities_are_bytes_ = true;
        if (wanted[static_cast<std::size_t>(SphereValue::red)]) colors_are_bytes_ = true;
    }
    return wanted;
}

void SphereBuilder::have_elements(double units_per_angstrom) {
    element_scale_ = units_per_angstrom;
}

void SphereBuilder::require_columns() const {
    const auto require = [&](const std::string& column, SphereValue value, const char* key) {
        if (column.empty() || claimed(value)) return;
        if (value == SphereValue::scalar && column == "element" && element_scale_) return;
        if (columns_.empty()) {
            throw InputError(path_, fmt::format("it has no column '{}' for {}", column, key), "it has no columns");
        }
        std::vector<std::string_view> known(columns_.begin(), columns_.end());
        throw InputError(path_, fmt::format("it has no column '{}' for {}", column, key),
                         fmt::format("did you mean '{}'?", nearest_word(column, known)));
    };
    require(settings_.radius_column, SphereValue::radius, "radius_column");
    require(settings_.color_column, SphereValue::scalar, "color_column");
    require(settings_.opacity_column, SphereValue::opacity, "opacity_column");
    if (!settings_.radius && !claimed(SphereValue::radius) && !element_scale_) {
        throw InputError(path_, "it does not say how large its spheres are", "give radius or radius_column");
    }
}

void SphereBuilder::require_memory(std::uint64_t count) const {
    const std::uint64_t each = sizeof(Sphere) + (coloring_ != Coloring::none || by_columns_ ? 4 : 0) +
                               (claimed(SphereValue::opacity) || by_columns_ ? sizeof(float) : 0);
    const std::uint64_t available = available_memory_bytes();
    if (count <= available / each) return;
    throw InputError(path_, fmt::format("its {} spheres need {:.1f} GB of memory, and there are {:.1f} GB", count,
                                        static_cast<double>(count) * static_cast<double>(each) * 1e-9,
                                        static_cast<double>(available) * 1e-9));
}

void SphereBuilder::choose_coloring() {
    const bool has_rgb = claimed(SphereValue::red) && claimed(SphereValue::green) && claimed(SphereValue::blue);
    if (claimed(SphereValue::scalar)) {
        coloring_ = Coloring::scalar;
    } else if (has_rgb && settings_.color_column.empty()) {
        coloring_ = Coloring::rgb;
    } else if (element_scale_) {
        coloring_ = Coloring::element;
    }
}

void SphereBuilder::begin(std::optional<std::uint64_t> count) {
    require_columns();
    choose_coloring();
    if (!count) return;
    require_memory(*count);
    spheres_.reserve(*count);
    if (coloring_ != Coloring::none) colors_.reserve(*count);
    if (claimed(SphereValue::opacity)) opacities_.reserve(*count);
}

Sphere SphereBuilder::placed(const std::array<double, 3>& centre) const {
    const auto narrowed = [](double value) {
        return std::abs(value) <= most_float ? static_cast<float>(value) : std::numeric_limits<float>::quiet_NaN();
    };
    const auto [x, y, z] = centre;
    if (settings_.up == SphereAxes::y) return {{narrowed(x), narrowed(-z), narrowed(y)}, 0};
    return {{narrowed(x), narrowed(y), narrowed(z)}, 0};
}

float SphereBuilder::checked_radius(double radius, std::int64_t line, std::size_t record) const {
    const double scaled = radius * settings_.radius_scale;
    const bool fits = scaled > 0 && scaled <= most_float && static_cast<float>(scaled) > 0;
    if (fits) return static_cast<float>(scaled);
    const std::string cure = "radii are above 0; give radius, or another radius_column";
    if (line > 0) {
        throw InputError(
            InputErrorParts{path_, std::nullopt, fmt::format("a sphere of radius {}", scaled), cure, line});
    }
    throw InputError(path_, fmt::format("sphere {} (counted from 0) has the radius {}", record, scaled), cure);
}

float SphereBuilder::checked_opacity(double opacity) {
    if (opacities_are_bytes_) opacity /= 255;
    if (!(opacity >= 0 && opacity <= 1)) {
        ++clamped_opacities_;
        opacity = opacity < 0 ? 0 : 1;
    }
    return static_cast<float>(opacity * settings_.opacity);
}

void SphereBuilder::put_scalar(std::array<std::uint8_t, 4>& color, double number) {
    const float value =
        std::abs(number) <= most_float ? static_cast<float>(number) : std::numeric_limits<float>::quiet_NaN();
    if (std::isfinite(value)) {
        least_scalar_ = std::min(least_scalar_, value);
        most_scalar_ = std::max(most_scalar_, value);
    } else {
        ++odd_colors_;
    }
    color = std::bit_cast<std::array<std::uint8_t, 4>>(value);
}

void SphereBuilder::put_color(std::array<std::uint8_t, 4>& color, SphereValue value, double number) {
    const std::size_t channel = static_cast<std::size_t>(value) - static_cast<std::size_t>(SphereValue::red);
    if (!(number >= 0 && number <= 255)) {
        ++odd_colors_;
        number = number < 0 ? 0 : number > 255 ? 255 : 0;
    }
    most_color_ = std::max(most_color_, number);
    const bool is_fraction = !colors_are_bytes_ && number <= 1;
    color[channel] = static_cast<std::uint8_t>(std::lround(is_fraction ? number * 255 : number));
    const auto flag = static_cast<std::uint8_t>(1u << channel);
    color[fraction_flags] =
        static_cast<std::uint8_t>(is_fraction ? color[fraction_flags] | flag : color[fraction_flags] & ~flag);
}

void SphereBuilder::add(const SphereRecord& record) {
    const auto value = [&](SphereValue which) { return record.values[static_cast<std::size_t>(which)]; };
    Sphere sphere = placed(record.centre);
    if (!is_somewhere(sphere)) {
        ++nowhere_;
        return;
    }
    const bool by_element = !settings_.radius && !claimed(SphereValue::radius);
    const double radius = claimed(SphereValue::radius) ? value(SphereValue::radius)
                          : settings_.radius           ? *settings_.radius
                                                       : element(record.element).radius_angstrom * *element_scale_;
    sphere.radius_m = checked_radius(radius, record.line, spheres_.size());
    if (element_scale_ && record.element == 0 && (by_element || coloring_ == Coloring::element)) ++unknown_elements_;
    if (spheres_.is_full()) require_memory(BlockList<Sphere>::block_items);
    spheres_.push_back(sphere);

    if (claimed(SphereValue::opacity)) opacities_.push_back(checked_opacity(value(SphereValue::opacity)));
    if (coloring_ == Coloring::none) return;
    std::array<std::uint8_t, 4> color{};
    if (coloring_ == Coloring::scalar) {
        put_scalar(color, value(SphereValue::scalar));
    } else if (coloring_ == Coloring::rgb) {
        for (const SphereValue channel : {SphereValue::red, SphereValue::green, SphereValue::blue}) {
            put_color(color, channel, value(channel));
        }
    } else {
        const std::uint32_t rgb = element(record.element).color;
        color = {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8 & 255),
                 static_cast<std::uint8_t>(rgb & 255), 0};
    }
    colors_.push_back(color);
}

void SphereBuilder::begin_columns(std::uint64_t count) {
    by_columns_ = true;
    require_memory(count);
    const float unset = std::numeric_limits<float>::quiet_NaN();
    spheres_.resize(count, {{unset, unset, unset}, unset});
}

void SphereBuilder::set_centre(std::size_t sphere, const std::array<double, 3>& centre) {
    spheres_[sphere].centre_m = placed(centre).centre_m;
}

void SphereBuilder::set(std::size_t sphere, SphereValues wanted, double value) {
    for (std::size_t i = 0; i < sphere_value_count; ++i) {
        if (!wanted[i]) continue;
        const auto which = static_cast<SphereValue>(i);
        if (which == SphereValue::radius) {
            const double scaled = value * settings_.radius_scale;
            spheres_[sphere].radius_m =
                std::abs(scaled) <= most_float ? static_cast<float>(scaled) : std::numeric_limits<float>::quiet_NaN();
        } else if (which == SphereValue::opacity) {
            opacities_.resize(spheres_.size(), 1);
            opacities_[sphere] = checked_opacity(value);
        } else {
            colors_.resize(spheres_.size(), {});
            if (which == SphereValue::scalar) {
                put_scalar(colors_[sphere], value);
            } else {
                put_color(colors_[sphere], which, value);
            }
        }
    }
}

std::size_t SphereBuilder::checked_columns() {
    require_columns();
    choose_coloring();
    const std::size_t count = spheres_.size();
    if (coloring_ != Coloring::none) colors_.resize(count, {});
    if (claimed(SphereValue::opacity)) opacities_.resize(count, 1);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        Sphere sphere = spheres_[i];
        if (!is_somewhere(sphere)) {
            ++nowhere_;
            continue;
        }
        if (!claimed(SphereValue::radius)) {
            sphere.radius_m = checked_radius(*settings_.radius, 0, i);
        } else if (!(sphere.radius_m > 0)) {
            checked_radius(sphere.radius_m / settings_.radius_scale, 0, i);
        }
        spheres_[kept] = sphere;
        if (colors_.size() > 0) colors_[kept] = colors_[i];
        if (opacities_.size() > 0) opacities_[kept] = opacities_[i];
        ++kept;
    }
    return kept;
}

void SphereBuilder::finish_colors(std::vector<std::array<std::uint8_t, 4>>& colors) const {
    if (coloring_ == Coloring::scalar) {
        const auto table = color_map_table(settings_.color_map);
        const double from = settings_.color_range ? (*settings_.color_range)[0] : least_scalar_;
        const double to = settings_.color_range ? (*settings_.color_range)[1] : most_scalar_;
        const double entries_per_unit = to > from ? 255 / (to - from) : 0;
        for (std::array<std::uint8_t, 4>& color : colors) {
            const double value = std::bit_cast<float>(color);
            if (!std::isfinite(value)) {
                color = {128, 128, 128, 255};
                continue;
            }
            const double entry = std::clamp((value - from) * entries_per_unit, 0.0, 255.0);
            color = table[static_cast<std::size_t>(std::lround(entry))];
        }
    } else {
        const bool were_bytes = most_color_ > 1 && !colors_are_bytes_;
        for (std::array<std::uint8_t, 4>& color : colors) {
            for (std::size_t c = 0; c < 3 && were_bytes; ++c) {
                // A fraction of a code value is at most one.
                if ((color[fraction_flags] >> c & 1) != 0) color[c] = color[c] >= 128 ? 1 : 0;
            }
            color[fraction_flags] = 255;
        }
    }
}

void SphereBuilder::warn() {
    const auto count = [&](std::uint64_t number, const char* words) {
        if (number > 0) warnings_.add(fmt::format("{}: {} {}", path_.string(), number, words));
    };
    count(nowhere_, "spheres whose place is not finite are left out");
    count(unknown_elements_, "atoms of no known element are drawn with a radius of 2 Å, pink");
    count(clamped_opacities_, "opacities outside 0 to 1 are clamped, those that are no number to 1");
    count(odd_colors_, "colours that are not finite or out of range are clamped or grey");
}

SphereSet SphereBuilder::finish() {
    const std::size_t count = by_columns_ ? checked_columns() : spheres_.size();
    warn();
    if (count == 0) warnings_.add(fmt::format("{}: it holds no spheres", path_.string()));
    SphereSet set;
    set.name = path_.stem().string();
    set.columns = std::move(columns_);
    set.spheres = spheres_.take(count);
    if (coloring_ != Coloring::none) {
        set.colors = colors_.take(count);
        finish_colors(set.colors);
    }
    if (claimed(SphereValue::opacity)) set.opacities = opacities_.take(count);
    set.opacity = static_cast<float>(settings_.opacity);
    set.update_bounds();
    return set;
}

}  // namespace matchlight
