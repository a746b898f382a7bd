// The formats that sphere sets come in, one file each.
#pragma once

#include "scene/chunked_file.h"
#include "scene/sphere_builder.h"

namespace matchlight {

// Each reads one file from its beginning into `builder`, and throws InputError where it is not what its kind should be.
// `frame` counts the frames of a trajectory from 0.
void read_xyz_spheres(ChunkedFile& file, std::int64_t frame, SphereBuilder& builder);
void read_csv_spheres(ChunkedFile& file, SphereBuilder& builder);
void read_pdb_spheres(ChunkedFile& file, std::int64_t frame, SphereBuilder& builder);
void read_mmcif_spheres(ChunkedFile& file, std::int64_t frame, SphereBuilder& builder);
void read_gro_spheres(ChunkedFile& file, std::int64_t frame, SphereBuilder& builder);
void read_ply_spheres(ChunkedFile& file, SphereBuilder& builder);
void read_vtk_spheres(ChunkedFile& file, SphereBuilder& builder);
void read_vtp_spheres(ChunkedFile& file, SphereBuilder& builder);
void read_bgeo_spheres(ChunkedFile& file, SphereBuilder& builder);

}  // namespace matchlight
