// Chooses the reader by the file's extension.
#include "scene/sphere_file.h"

#include <algorithm>
#include <new>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/sphere_readers.h"

namespace matchlight {
namespace {

/// In small letters; of "atoms.xyz.gz" that of "atoms.xyz".
std::string kind_of(const std::filesystem::path& path) {
    const auto small = [](std::string text) {
        std::transform(text.begin(), text.end(), text.begin(),
                       [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
        return text;
    };
    const std::string extension = small(path.extension().string());
    return extension == ".gz" ? small(path.stem().extension().string()) : extension;
}

void read_spheres(ChunkedFile& file, std::int64_t frame, SphereBuilder& builder) {
    const std::string kind = kind_of(file.path());
    if (kind == ".xyz" || kind == ".extxyz") return read_xyz_spheres(file, frame, builder);
    if (kind == ".csv" || kind == ".tsv" || kind == ".txt") return read_csv_spheres(file, builder);
    if (kind == ".pdb" || kind == ".ent") return read_pdb_spheres(file, frame, builder);
    if (kind == ".cif" || kind == ".mmcif") return read_mmcif_spheres(file, frame, builder);
    if (kind == ".gro") return read_gro_spheres(file, frame, builder);
    if (kind == ".ply") return read_ply_spheres(file, builder);
    if (kind == ".vtk") return read_vtk_spheres(file, builder);
    if (kind == ".vtp" || kind == ".vtu") return read_vtp_spheres(file, builder);
    if (kind == ".bgeo") return read_bgeo_spheres(file, builder);
    throw InputError(file.path(), fmt::format("sphere sets of kind '{}' are not supported", kind),
                     "use .xyz, .pdb, .cif, .gro, .csv, .vtk, .vtp, .ply or .bgeo");
}

}  // namespace

SphereSet load_sphere_set(const std::filesystem::path& path, const SphereSettings& settings, Warnings& warnings) {
    try {
        ChunkedFile file(path);
        SphereBuilder builder(path, settings, warnings);
        read_spheres(file, settings.frame, builder);
        return builder.finish();
    } catch (const std::bad_alloc&) {
        throw InputError(path, "it does not fit into memory");
    }
}

void add_sphere_contents(ContentHash& hash, const std::filesystem::path& path) {
    hash.add_file(path);
}

}  // namespace matchlight
