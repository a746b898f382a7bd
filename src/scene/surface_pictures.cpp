// Pictures on a model: where they lie, how they are read, which of them there are.
#include "scene/surface_pictures.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/error.h"
#include "core/transfer.h"
#include "scene/mesh_geometry.h"
#include "scene/relief_map.h"
#include "scene/texture_image.h"

namespace matchlight {

namespace {

void scale_coordinates(Model& model, double scale) {
    const auto factor = static_cast<float>(scale);
    for (ModelMesh& mesh : model.meshes) {
        for (ModelVertex& vertex : mesh.vertices) {
            for (float& coordinate : vertex.uv) coordinate *= factor;
            for (float& coordinate : vertex.uv_second) coordinate *= factor;
        }
    }
}

void set_sampling(TextureSampling& sampling, const PictureSampling& chosen) {
    if (chosen.filter) {
        const bool smooth = *chosen.filter != PictureFilter::nearest;
        sampling.is_smooth_near = sampling.is_smooth_far = smooth;
        sampling.mipmaps = *chosen.filter == PictureFilter::mipmapped ? TextureMipmaps::linear : TextureMipmaps::none;
    }
    if (chosen.wrap) {
        constexpr TextureWrap wraps[] = {TextureWrap::repeat, TextureWrap::clamp, TextureWrap::mirror};
        sampling.wrap_u = sampling.wrap_v = wraps[static_cast<std::size_t>(*chosen.wrap)];
    }
    if (chosen.anisotropy) sampling.anisotropy = *chosen.anisotropy;
}

Image8 picture_of(const std::filesystem::path& file) {
    Warnings unheard;  // what a model's own texture may lack, one that the scene asks for may not
    unheard.set_quiet(true);
    auto pixels = read_texture({.name = file.filename().string(), .bytes = {}, .file = file}, file, unheard);
    if (!pixels) throw InputError(file, "it is no picture that can be read", "give a PNG or JPEG file");
    return std::move(*pixels);
}

void set_normal_map(Model& model, const std::filesystem::path& file) {
    const auto index = static_cast<int>(model.textures.size());
    model.textures.push_back({.name = file.string(), .rgba = picture_of(file), .sampling = {}});
    for (ModelMaterial& material : model.materials) material.use(MaterialSlot::normal) = {index, {}};
    for (ModelMesh& mesh : model.meshes) {
        // Vertices that a rig moves stay as many as they are.
        if (mesh.binding) {
            repair_tangents(mesh);
        } else {
            compute_tangents(mesh);
        }
    }
}

/// How long u and v are on the model, each the mean over its surface.
std::pair<double, double> extents_of(const Model& model) {
    double area = 0, along_u = 0, along_v = 0;
    for (const ModelMesh& mesh : model.meshes) {
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            const ModelVertex &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                              &c = mesh.vertices[mesh.indices[i + 2]];
            const auto position = [](const ModelVertex& vertex) {
                return Eigen::Vector3f(vertex.position.data()).cast<double>().eval();
            };
            const Eigen::Vector3d e1 = position(b) - position(a), e2 = position(c) - position(a);
            const double u1 = b.uv[0] - a.uv[0], v1 = b.uv[1] - a.uv[1], u2 = c.uv[0] - a.uv[0], v2 = c.uv[1] - a.uv[1];
            const double of_picture = u1 * v2 - u2 * v1;
            if (std::abs(of_picture) < 1e-20) continue;
            const double weight = e1.cross(e2).norm();
            area += weight;
            along_u += weight * ((e1 * v2 - e2 * v1) / of_picture).norm();
            along_v += weight * ((e2 * u1 - e1 * u2) / of_picture).norm();
        }
    }
    return area > 0 ? std::pair(along_u / area, along_v / area) : std::pair(0.0, 0.0);
}

/// In light, between the four nearest pixels.
Image8 resized(const Image8& image, int width, int height) {
    if (image.width() == width && image.height() == height) return image;
    Image8 result(width, height, 4);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double column = (x + 0.5) * image.width() / width - 0.5;
            const double row = (y + 0.5) * image.height() / height - 0.5;
            const double left = std::floor(column), top = std::floor(row);
            std::array<double, 4> sum{};
            for (int i = 0; i < 4; ++i) {
                const double across = (i & 1) == 1 ? column - left : 1 - column + left;
                const double down = (i >> 1) == 1 ? row - top : 1 - row + top;
                const std::uint8_t* from =
                    image.pixel(std::clamp(static_cast<int>(left) + (i & 1), 0, image.width() - 1),
                                std::clamp(static_cast<int>(top) + (i >> 1), 0, image.height() - 1));
                for (std::size_t c = 0; c < 4; ++c) {
                    const double value = from[c] / 255.0;
                    sum[c] += across * down * (c < 3 ? linear_from_srgb_code(value) : value);
                }
            }
            for (std::size_t c = 0; c < 4; ++c) {
                const double value = c < 3 ? srgb_code_from_linear(sum[c]) : sum[c];
                result.pixel(x, y)[c] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
            }
        }
    }
    return result;
}

std::vector<Image8> read_layers(const std::vector<PictureLayer>& layers) {
    std::vector<Image8> pictures;
    int width = 1, height = 1;
    for (const PictureLayer& layer : layers) {
        pictures.push_back(picture_of(layer.texture));
        width = std::max(width, pictures.back().width());
        height = std::max(height, pictures.back().height());
    }
    for (Image8& picture : pictures) picture = resized(picture, width, height);
    return pictures;
}

PictureWrap wrap_of(const PictureSampling& sampling) {
    return sampling.wrap.value_or(PictureWrap::repeat);
}

}  // namespace

SurfacePictures load_surface_pictures(Model& model, const MaterialOverride& material, Warnings& warnings) {
    const SurfaceDetail& detail = material.detail;
    SurfacePictures pictures{.settings = detail, .relief_wrap = wrap_of(detail.sampling), .heights = {}, .layers = {}};
    if (!detail.normal_map.empty()) set_normal_map(model, detail.normal_map);
    if (detail.uv_scale != 1) scale_coordinates(model, detail.uv_scale);
    for (ModelTexture& texture : model.textures) set_sampling(texture.sampling, detail.sampling);
    pictures.layers = read_layers(detail.layers);
    // A map that is flat is read all the same: what is wrong with it is said.
    if (!detail.relief.height_map.empty()) pictures.heights = read_heights(detail.relief.height_map, warnings);
    if (!detail.relief.present()) pictures.heights = {};
    std::tie(pictures.u_extent, pictures.v_extent) = extents_of(model);
    const bool needs_coordinates = !pictures.heights.empty() || !pictures.layers.empty() || !detail.normal_map.empty();
    if (needs_coordinates && pictures.u_extent == 0) {
        warnings.add(fmt::format("{}: it has no texture coordinates, so that no picture can lie on it", model.name));
        pictures.heights = {};
        pictures.layers.clear();
    }
    return pictures;
}

}  // namespace matchlight
