// matchlight doctor: what this machine has of what the program needs.
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <unistd.h>

extern "C" {
#include <libavutil/avutil.h>
}
#include <OpenEXR/OpenEXRConfig.h>
#include <OpenImageIO/imageio.h>

#include "commands/command.h"
#include "commands/result.h"
#include "core/error.h"
#include "core/memory.h"
#include "core/version.h"
#include "gl/context.h"
#include "gl/shader_library.h"
#include "media/frame_sink.h"

namespace matchlight {
namespace {

using nlohmann::json;

struct Findings {
    std::optional<GlInfo> gl;
    bool timer_queries = false;
    std::string gl_problem;
    std::string shaders;
    std::string shader_problem;
    std::vector<std::string> encoders;
    std::uint64_t memory_total_bytes = 0, memory_available_bytes = 0;
    unsigned cores = 0;
    std::vector<std::pair<std::string, std::string>> libraries;
};

Findings examine() {
    Findings found;
    try {
        const std::unique_ptr<GlContext> context = create_offscreen_context();
        found.gl = context->info();
        found.timer_queries = context->timer_queries_are_reliable();
    } catch (const InputError& error) {
        found.gl_problem = error.what();
    }
    try {
        found.shaders = shader_root().string();
    } catch (const InputError& error) {
        found.shader_problem = error.what();
    }
    found.encoders = available_video_encoders();
    found.memory_total_bytes =
        static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    found.memory_available_bytes = available_memory_bytes();
    found.cores = std::thread::hardware_concurrency();
    const int image_io = OIIO::openimageio_version();
    found.libraries = {
        {"FFmpeg", av_version_info()},
        {"OpenCV", cv::getVersionString()},
        {"OpenImageIO", fmt::format("{}.{}.{}", image_io / 10000, image_io / 100 % 100, image_io % 100)},
        {"OpenEXR", OPENEXR_VERSION_STRING},
        {"Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
    };
    return found;
}

json as_json(const Findings& found) {
    json result = {
        {"matchlight", version},
        {"gl", nullptr},
        {"shaders", nullptr},
        {"video_encoders", found.encoders},
        {"memory", {{"total_bytes", found.memory_total_bytes}, {"available_bytes", found.memory_available_bytes}}},
        {"cores", found.cores},
        {"libraries", json::object()}};
    if (const auto& gl = found.gl) {
        result["gl"] = {{"platform", gl->platform},
                        {"vendor", gl->vendor},
                        {"renderer", gl->renderer},
                        {"version", gl->version},
                        {"shading_language", gl->shading_language},
                        {"software", gl->is_software},
                        {"timer_queries", found.timer_queries},
                        {"max_samples", gl->max_samples},
                        {"max_texture_size", gl->max_texture_size},
                        {"max_storage_block_bytes", gl->max_storage_block_bytes}};
    } else {
        result["gl_problem"] = found.gl_problem;
    }
    if (found.shader_problem.empty()) {
        result["shaders"] = found.shaders;
    } else {
        result["shader_problem"] = found.shader_problem;
    }
    for (const auto& [name, number] : found.libraries) result["libraries"][name] = number;
    return result;
}

std::string as_text(const Findings& found) {
    std::string text = fmt::format("matchlight   {}\n", version);
    if (const auto& gl = found.gl) {
        text += fmt::format("OpenGL       {} ({})\n", gl->version, gl->platform);
        text += fmt::format("  renderer   {}, {}\n", gl->renderer, gl->vendor);
        text +=
            fmt::format("  kind       {}\n", gl->is_software ? "software: frames take longer than on a GPU" : "GPU");
        text += fmt::format("  limits     {} samples a pixel, textures to {} pixels, storage blocks to {} MiB\n",
                            gl->max_samples, gl->max_texture_size, gl->max_storage_block_bytes >> 20);
        text += fmt::format("  timing     {}\n", found.timer_queries ? "timer queries" : "wall clock");
    } else {
        text += fmt::format("OpenGL       none that can be used: {}\n", found.gl_problem);
    }
    text += fmt::format("shaders      {}\n", found.shader_problem.empty() ? found.shaders : found.shader_problem);
    text += fmt::format("encoders     {}\n",
                        found.encoders.empty() ? "none" : fmt::format("{}", fmt::join(found.encoders, ", ")));
    text += fmt::format("memory       {:.1f} GiB, {:.1f} GiB available\n",
                        static_cast<double>(found.memory_total_bytes) / (1 << 30),
                        static_cast<double>(found.memory_available_bytes) / (1 << 30));
    text += fmt::format("cores        {}\n", found.cores);
    std::vector<std::string> libraries;
    for (const auto& [name, number] : found.libraries) libraries.push_back(name + " " + number);
    text += fmt::format("libraries    {}\n", fmt::join(libraries, ", "));
    return text;
}

}  // namespace

void add_doctor_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("doctor", "What GL, codecs and memory this machine has");
    command->callback([&context] {
        const Findings found = examine();
        print_result(context, as_json(found), as_text(found));
        if (!found.gl_problem.empty()) throw InputError({}, found.gl_problem);
        if (!found.shader_problem.empty()) throw InputError({}, found.shader_problem);
    });
}

}  // namespace matchlight
