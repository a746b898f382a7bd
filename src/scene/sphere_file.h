// Reads sphere sets from the files of simulation and chemistry programs.
#pragma once

#include <filesystem>

#include "core/content_hash.h"
#include "core/warnings.h"
#include "scene/scene_file.h"
#include "scene/sphere_set.h"

namespace matchlight {

/// Reads a sphere set, in the file's own units; nothing but the spheres themselves is held in memory. Spheres whose
/// place is not finite are left out and counted as warnings. Throws InputError: radii that are not above 0, columns
/// that are not there, truncated files, counts beyond the file or the memory there is.
SphereSet load_sphere_set(const std::filesystem::path& path, const SphereSettings& settings, Warnings& warnings);

/// Adds the bytes of the file that load_sphere_set would read. Throws InputError when it cannot be read.
void add_sphere_contents(ContentHash& hash, const std::filesystem::path& path);

}  // namespace matchlight
