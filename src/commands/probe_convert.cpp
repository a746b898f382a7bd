// matchlight probe convert: a light probe in another mapping or size.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/probe_commands.h"
#include "commands/probe_options.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/version.h"
#include "lighting/latlong_lookup.h"
#include "lighting/probe_file.h"
#include "lighting/probe_record.h"
#include "lighting/resample.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ProbeConvertOptions {
    fs::path input, output;
    std::optional<ProbeMapping> from;
    ProbeMapping to = ProbeMapping::latlong;
    CubeLayout cube = CubeLayout::vertical_cross;
    int size_px = 0;  // 0: what the input holds
    ProbePlacement placement;
    bool overwrite = false;
};

void check_conversion(const ProbeConvertOptions& options) {
    std::error_code error;
    if (options.input == options.output || fs::equivalent(options.input, options.output, error)) {
        throw InputError(options.output, "the output is the input", "give another name");
    }
    check_output(options.output, options.overwrite);
    require_probe_extension(options.output);
}

/// The layout to write: `size_px` is the image's width, for a cube the side of a face.
ProbeLayout wanted_layout(const ProbeConvertOptions& options, const ProbeLayout& from) {
    int size = size_for_latlong(options.to, latlong_height_for(from));
    if (options.size_px > 0) {
        size = options.to == ProbeMapping::latlong ? std::max(1, options.size_px / 2) : options.size_px;
    } else if (options.to == from.mapping) {
        size = from.mapping == ProbeMapping::cube      ? from.face_size()
               : from.mapping == ProbeMapping::latlong ? from.height
                                                       : from.width;
    }
    return layout_of_size(options.to, size, options.cube);
}

/// What the input says of its pixels, turned and resampled as its light is.
RecordedChannels converted(const ProbeRecord& record, double rotation_deg, const ProbeLayout& to) {
    RecordedChannels result;
    std::vector<const ImageF*> maps;
    const auto take = [&](const char* name, const std::optional<ImageF>& map) {
        if (!map) return;
        result.names.emplace_back(name);
        maps.push_back(&*map);
    };
    take("sigma", record.sigma);
    take("seen", record.seen);
    take("clipped", record.clipped);
    if (record.nearness) maps.push_back(&*record.nearness);
    if (maps.empty()) return result;
    ImageF all(maps[0]->width(), maps[0]->height(), static_cast<int>(maps.size()));
    for (int y = 0; y < all.height(); ++y) {
        for (int x = 0; x < all.width(); ++x) {
            for (int c = 0; c < all.channels(); ++c) all.at(x, y, c) = maps[static_cast<std::size_t>(c)]->at(x, y);
        }
    }
    if (rotation_deg != 0) all = turned_latlong(all, rotation_deg);
    result.image = resample(all, layout_of_size(ProbeMapping::latlong, all.height()), to);
    if (record.nearness) store_distances(result, result.image.channels() - 1);
    return result;
}

void run_convert(const ProbeConvertOptions& options, CommandContext& context) {
    check_conversion(options);
    const OutputLock lock(options.output);
    ProbeImage file = read_probe_image(options.input, options.from, context.warnings);
    const ProbeLayout to = wanted_layout(options, file.layout);

    const ProbeRecord record = read_probe_record(options.input, file);
    ImageMetadata metadata = record.metadata;
    metadata["software"] = std::string("matchlight ") + version;
    metadata.emplace("source", options.input.filename().string());  // unless the input names its own
    ImageF image;
    if (options.placement.rotation_deg != 0 || options.placement.exposure_ev != 0) {
        metadata["rotation_deg"] = fmt::format("{}", options.placement.rotation_deg);
        metadata["exposure_ev"] = fmt::format("{}", options.placement.exposure_ev);
        image = image_from_probe(placed(unwrapped(file), options.placement), to);
    } else {
        image = resample(file.image, file.layout, to);
    }
    write_probe_image(options.output, image, to, metadata, converted(record, options.placement.rotation_deg, to));

    json result{{"file", options.output.string()},
                {"width", to.width},
                {"height", to.height},
                {"mapping", name_of(to.mapping)},
                {"from", name_of(file.layout.mapping)}};
    std::string mapping = name_of(to.mapping);
    if (to.mapping == ProbeMapping::cube) {
        result["cube_layout"] = name_of(to.cube);
        mapping += " (" + name_of(to.cube) + ")";
    }
    print_result(context, result,
                 fmt::format("{}: {} x {} pixels, {}, from {} {}", options.output.string(), to.width, to.height,
                             mapping, name_of(file.layout.mapping), options.input.string()));
}

}  // namespace

void add_probe_convert_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command =
        probe.add_subcommand("convert", "Write a probe in another mapping or size, every lamp keeping its energy");
    const auto options = std::make_shared<ProbeConvertOptions>();
    command->add_option("IN", options->input, "An .exr or .hdr image of all directions")->required();
    command->add_option("-o,--output", options->output, "Where to write: .exr or .hdr")->required();
    command->add_option("--to", options->to, "latlong, angular, mirrorball or cube")
        ->required()
        ->transform(CLI::CheckedTransformer(mappings_by_name()).description(""))
        ->type_name("MAPPING");
    add_from_option(*command, options->from);
    command
        ->add_option("--size", options->size_px,
                     "Width of the result in pixels; of a cube, the side of a face (default: what the input holds)")
        ->check(CLI::Range(4, 16384).description(""))
        ->type_name("PIXELS");
    command
        ->add_option("--cube-layout", options->cube,
                     "vertical-cross (default), horizontal-cross, strip (OpenGL's order), column (OpenEXR's)")
        ->transform(CLI::CheckedTransformer(cubes_by_name()).description(""))
        ->type_name("LAYOUT");
    command
        ->add_option("--rotation-deg", options->placement.rotation_deg,
                     "Turn the light counter-clockwise seen from above")
        ->check(within(3600))
        ->type_name("DEGREES");
    command->add_option("--exposure-ev", options->placement.exposure_ev, "Multiply the light by 2^EV")
        ->check(within(64))
        ->type_name("EV");
    command->add_flag("--overwrite", options->overwrite, "Replace a file that exists");
    command->callback([options, &context] { run_convert(*options, context); });
}

}  // namespace matchlight
