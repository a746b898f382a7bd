// Writes sphere sets as they come: PLY (binary), extended XYZ or CSV by the file's extension.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/atomic_file.h"
#include "scene/sphere_set.h"

namespace matchlight {

/// Columns beside place and radius.
struct SphereColumns {
    bool colors = false;
    bool opacities = false;
};

/// Throws InputError unless SphereWriter writes files of this extension.
void check_sphere_extension(const std::filesystem::path& path);

/// The file appears under its name with finish().
class SphereWriter {
public:
    /// Throws InputError where the extension is none of these or the file cannot be written.
    SphereWriter(const std::filesystem::path& path, std::uint64_t count, const SphereColumns& columns);

    void add(const Sphere& sphere, const std::array<std::uint8_t, 4>& color = {}, float opacity = 1);
    void finish();

private:
    enum class Kind { ply, xyz, csv };
    friend void check_sphere_extension(const std::filesystem::path& path);

    static Kind kind_of(const std::filesystem::path& path);
    void write_header(std::uint64_t count);
    void flush();

    Kind kind_;
    SphereColumns columns_;
    PendingFile file_;
    std::ofstream stream_;
    std::string buffer_;
};

/// Writes a whole set.
void write_sphere_set(const std::filesystem::path& path, const SphereSet& set);

}  // namespace matchlight
