// A buffer that goes to the disk a megabyte at a time.
#include "scene/sphere_write.h"

#include <bit>
#include <iterator>

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {
namespace {

constexpr std::size_t buffer_bytes = 1u << 20;

void append_little_endian(std::string& bytes, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 255);
}

}  // namespace

SphereWriter::Kind SphereWriter::kind_of(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    if (extension == ".ply") return Kind::ply;
    if (extension == ".xyz") return Kind::xyz;
    if (extension == ".csv") return Kind::csv;
    throw InputError(path, fmt::format("sphere sets are not written as '{}'", extension), "use .ply, .xyz or .csv");
}

void check_sphere_extension(const std::filesystem::path& path) {
    SphereWriter::kind_of(path);
}

SphereWriter::SphereWriter(const std::filesystem::path& path, std::uint64_t count, const SphereColumns& columns)
    : kind_(kind_of(path)), columns_(columns), file_(path), stream_(file_.path(), std::ios::binary | std::ios::trunc) {
    buffer_.reserve(buffer_bytes + 256);
    write_header(count);
    flush();
}

void SphereWriter::write_header(std::uint64_t count) {
    switch (kind_) {
        case Kind::ply:
            buffer_ = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", count);
            for (const char* name : {"x", "y", "z", "radius"}) buffer_ += fmt::format("property float {}\n", name);
            if (columns_.colors) buffer_ += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
            if (columns_.opacities) buffer_ += "property float opacity\n";
            buffer_ += "end_header\n";
            break;
        case Kind::xyz:
            buffer_ = fmt::format("{}\nProperties=pos:R:3:radius:R:1{}{}\n", count,
                                  columns_.colors ? ":red:I:1:green:I:1:blue:I:1" : "",
                                  columns_.opacities ? ":opacity:R:1" : "");
            break;
        case Kind::csv:
            buffer_ = fmt::format("x,y,z,radius{}{}\n", columns_.colors ? ",red,green,blue" : "",
                                  columns_.opacities ? ",opacity" : "");
            break;
    }
}

void SphereWriter::add(const Sphere& sphere, const std::array<std::uint8_t, 4>& color, float opacity) {
    const auto& [x, y, z] = sphere.centre_m;
    if (kind_ == Kind::ply) {
        for (const float value : {x, y, z, sphere.radius_m}) append_little_endian(buffer_, value);
        if (columns_.colors)
            buffer_.append({static_cast<char>(color[0]), static_cast<char>(color[1]), static_cast<char>(color[2])});
        if (columns_.opacities) append_little_endian(buffer_, opacity);
    } else {
        // The shortest digits that give the same number again.
        const char separator = kind_ == Kind::csv ? ',' : ' ';
        auto end = std::back_inserter(buffer_);
        fmt::format_to(end, "{}{}{}{}{}{}{}", x, separator, y, separator, z, separator, sphere.radius_m);
        if (columns_.colors) {
            fmt::format_to(end, "{}{}{}{}{}{}", separator, color[0], separator, color[1], separator, color[2]);
        }
        if (columns_.opacities) fmt::format_to(end, "{}{}", separator, opacity);
        buffer_ += '\n';
    }
    if (buffer_.size() >= buffer_bytes) flush();
}

void SphereWriter::flush() {
    stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
    if (!stream_) throw InputError(file_.final_path(), "cannot be written", "free some space on the disk");
}

void SphereWriter::finish() {
    flush();
    stream_.close();
    if (!stream_) throw InputError(file_.final_path(), "cannot be written", "free some space on the disk");
    file_.commit();
}

void write_sphere_set(const std::filesystem::path& path, const SphereSet& set) {
    SphereWriter writer(path, set.size(), {.colors = !set.colors.empty(), .opacities = set.blends()});
    for (std::size_t i = 0; i < set.size(); ++i) {
        writer.add(set.spheres[i], set.colors.empty() ? std::array<std::uint8_t, 4>{} : set.colors[i],
                   set.opacities.empty() ? set.opacity : set.opacities[i]);
    }
    writer.finish();
}

}  // namespace matchlight
