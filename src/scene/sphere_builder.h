// Makes spheres of what a file says, as the settings map its columns: the part that all formats share.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/warnings.h"
#include "scene/block_list.h"
#include "scene/scene_file.h"
#include "scene/sphere_set.h"

namespace matchlight {

/// What a column of a file can say of a sphere.
enum class SphereValue { radius, scalar, opacity, red, green, blue };
inline constexpr std::size_t sphere_value_count = 6;
/// One bit a SphereValue: what a column is wanted for, often nothing.
using SphereValues = std::bitset<sphere_value_count>;

/// One sphere as a file has it.
struct SphereRecord {
    std::array<double, 3> centre{};
    std::array<double, sphere_value_count> values{};  // those that were claimed
    int element = 0;                                  // atomic number
    std::int64_t line = 0;                            // of a text file; 0: none

    void put(SphereValues wanted, double value) {
        for (std::size_t i = 0; i < sphere_value_count; ++i) {
            if (wanted[i]) values[i] = value;
        }
    }
};

enum class ColumnKind { number, byte };  // a byte holds colours and opacities as 0..255

/// Fed in one of two ways: claim() every column, begin(), add() sphere by sphere; or begin_columns() and then, in any
/// order, claim() and set() column by column.
class SphereBuilder {
public:
    /// `settings` and `warnings` outlive this.
    SphereBuilder(std::filesystem::path path, const SphereSettings& settings, Warnings& warnings);

    /// Says that the file has a column, and learns what it is wanted for.
    SphereValues claim(const std::string& column, ColumnKind kind = ColumnKind::number);
    /// Says that records have an element; its radius is in ångström, of which the file's unit is this many.
    void have_elements(double units_per_angstrom);

    /// Throws InputError: a column that is wanted and not there, spheres without radius, too many for the memory.
    void begin(std::optional<std::uint64_t> count);
    void add(const SphereRecord& record);

    void begin_columns(std::uint64_t count);
    void set_centre(std::size_t sphere, const std::array<double, 3>& centre);
    void set(std::size_t sphere, SphereValues wanted, double value);

    SphereSet finish();

private:
    enum class Coloring { none, scalar, rgb, element };

    void require_columns() const;
    void require_memory(std::uint64_t count) const;
    bool claimed(SphereValue value) const { return claimed_[static_cast<std::size_t>(value)]; }
    bool wanted_by_user(const std::string& column, SphereValue value) const;
    void choose_coloring();
    Sphere placed(const std::array<double, 3>& centre) const;
    float checked_radius(double radius, std::int64_t line, std::size_t record) const;
    float checked_opacity(double opacity);
    void put_color(std::array<std::uint8_t, 4>& color, SphereValue value, double number);
    void put_scalar(std::array<std::uint8_t, 4>& color, double number);
    /// Leaves out spheres that are nowhere, and checks the radii, of what came by columns.
    std::size_t checked_columns();
    void finish_colors(std::vector<std::array<std::uint8_t, 4>>& colors) const;
    void warn();

    std::filesystem::path path_;
    const SphereSettings& settings_;
    Warnings& warnings_;
    std::vector<std::string> columns_;
    SphereValues claimed_;
    std::optional<double> element_scale_;
    Coloring coloring_ = Coloring::none;
    bool by_columns_ = false;
    bool colors_are_bytes_ = false, opacities_are_bytes_ = false;

    BlockList<Sphere> spheres_;
    BlockList<std::array<std::uint8_t, 4>> colors_;  // of a scalar: its float, until all are known
    BlockList<float> opacities_;
    float least_scalar_ = std::numeric_limits<float>::infinity(), most_scalar_ = -least_scalar_;
    double most_color_ = 0;
    std::uint64_t nowhere_ = 0, unknown_elements_ = 0, clamped_opacities_ = 0, odd_colors_ = 0;
};

}  // namespace matchlight
