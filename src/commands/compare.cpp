// matchlight compare: how different two pictures, sequences or videos are.
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/command.h"
#include "commands/frame_range.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/progress.h"
#include "core/stop.h"
#include "media/image_io.h"
#include "report/change_region.h"
#include "report/compared_frames.h"
#include "report/comparison.h"
#include "report/flip_colors.h"
#include "report/image_error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct CompareOptions {
    fs::path reference, test;
    std::optional<fs::path> mask, region_plate, flip_map;
    FrameRange frames;
    std::int64_t first_reference = 0, first_test = 0;
    FlipOptions flip;
    bool strict = false, overwrite = false;
};

/// A stream of frames that can be asked for a number.
class FrameCursor {
public:
    FrameCursor(const fs::path& path, const ComparedFramesOptions& options, Warnings& warnings)
        : path_(path), still_(is_single_picture(path)), frames_(ComparedFrames::open(path, options, warnings)) {}

    const fs::path& path() const { return path_; }

    /// The frame in hand, or nullptr at the end.
    ComparedFrame* current() {
        if (!started_) advance();
        return frame_ ? &*frame_ : nullptr;
    }
    void advance() {
        started_ = true;
        frame_ = frames_->next();
    }
    /// The frame of that number; a single picture serves all numbers. Throws InputError when there is none.
    const ComparedFrame& at(std::int64_t number) {
        while (current() != nullptr && !still_ && current()->number < number) advance();
        if (current() == nullptr || (!still_ && current()->number != number)) {
            throw InputError(path_, number, "has no such frame");
        }
        return *current();
    }

private:
    fs::path path_;
    bool still_;
    std::unique_ptr<ComparedFrames> frames_;
    bool started_ = false;
    std::optional<ComparedFrame> frame_;
};

void check_same_size(const ComparedFrame& reference, const ComparedFrame& other) {
    if (reference.rgb.bounds() == other.rgb.bounds()) return;
    throw InputError(other.file, other.number,
                     fmt::format("is {}x{}, but {} is {}x{}", other.rgb.width(), other.rgb.height(),
                                 reference.file.string(), reference.rgb.width(), reference.rgb.height()),
                     "compare pictures of one size");
}

class Comparer {
public:
    Comparer(const CompareOptions& options, CommandContext& context)
        : options_(options),
          warnings_(context.warnings),
          quiet_(context.quiet),
          reference_(options.reference, frame_options(options.first_reference, false), warnings_),
          test_(options.test, frame_options(options.first_test, false), warnings_) {
        if (options.mask) mask_.emplace(*options.mask, frame_options(options.first_reference, true), warnings_);
        if (options.region_plate) {
            plate_.emplace(*options.region_plate, frame_options(options.first_reference, false), warnings_);
        }
        if (options.flip_map) check_flip_map();
    }

    /// Compares the frames that both have, by number.
    std::vector<FrameComparison> run() {
        std::vector<FrameComparison> results;
        Progress progress("compare", 0, quiet_);
        std::int64_t only_reference = 0, only_test = 0;
        while (reference_.current() != nullptr || test_.current() != nullptr) {
            if (stop_requested()) throw InputError(options_.test, "stopped on request");
            const std::int64_t r = number_of(reference_), t = number_of(test_);
            if (r == t) {
                results.push_back(compare_current());
                progress.advance();
            }
            only_reference += r < t ? 1 : 0;
            only_test += t < r ? 1 : 0;
            if (r <= t) reference_.advance();
            if (t <= r) test_.advance();
        }
        report_lonely(only_reference, only_test, !results.empty());
        return results;
    }

private:
    static constexpr std::int64_t past_the_end = std::numeric_limits<std::int64_t>::max();

    ComparedFramesOptions frame_options(std::int64_t first_number, bool is_mask) const {
        ComparedFramesOptions frames;
        frames.first_number = first_number;
        frames.first = options_.frames.first;
        frames.last = options_.frames.last;
        frames.strict = options_.strict;
        frames.is_mask = is_mask;
        return frames;
    }

    static std::int64_t number_of(FrameCursor& cursor) {
        const auto* frame = cursor.current();
        return frame != nullptr ? frame->number : past_the_end;
    }

    void check_flip_map() const {
        const fs::path& map = *options_.flip_map;
        const bool one_frame = is_single_picture(options_.reference) || is_single_picture(options_.test);
        if (!is_pattern(map) && !one_frame) {
            throw InputError(map, "names one file for many frames", "give a pattern such as map_%04d.png");
        }
        if (map.extension() != ".png")
            throw InputError(map, "the FLIP map is written as PNG", "give a name ending in .png");
        for (const fs::path& input : {options_.reference, options_.test}) {
            std::error_code error;
            if (map == input || fs::equivalent(map, input, error)) throw InputError(map, "the output is an input");
        }
        check_output(numbered(map, 0), true);
    }

    FrameComparison compare_current() {
        const ComparedFrame& reference = *reference_.current();
        const ComparedFrame& test = *test_.current();
        check_same_size(reference, test);
        ComparedPair pair{reference.rgb, test.rgb};
        if (reference.linear && test.linear) {
            pair.reference_linear = &*reference.linear;
            pair.test_linear = &*test.linear;
        }
        Image8 region;
        if (plate_) {
            const ComparedFrame& plate = plate_->at(reference.number);
            check_same_size(reference, plate);
            region = change_region(plate.rgb, reference.rgb);
            pair.plate = &plate.rgb;
            pair.mask = &region;
        } else if (mask_) {
            const ComparedFrame& mask = mask_->at(reference.number);
            check_same_size(reference, mask);
            pair.mask = &mask.rgb;
        }
        ImageF flip_map;
        FrameComparison result = compare_pictures(pair, options_.flip, options_.flip_map ? &flip_map : nullptr);
        result.frame = reference.number;
        if (options_.flip_map) {
            const fs::path path = numbered(*options_.flip_map, reference.number);
            check_output(path, options_.overwrite);
            write_png8(path, flip_colors(flip_map));
        }
        return result;
    }

    void report_lonely(std::int64_t only_reference, std::int64_t only_test, bool any) const {
        if (!any) {
            throw InputError(options_.test, "has no frame in common with " + options_.reference.string(),
                             "sequences count by the numbers of their names: see --first-reference and --first-test");
        }
        if (only_reference == 0 && only_test == 0) return;
        const std::string cause = fmt::format("{} frames of {} and {} of its own have no partner", only_reference,
                                              options_.reference.string(), only_test);
        if (options_.strict) throw InputError(options_.test, cause);
        warnings_.add(InputError(options_.test, cause).what());
    }

    const CompareOptions& options_;
    Warnings& warnings_;
    bool quiet_;
    FrameCursor reference_, test_;
    std::optional<FrameCursor> mask_, plate_;
};

json number_or_null(const std::optional<double>& value) {
    return value ? json(*value) : json(nullptr);
}

json measures_json(const ErrorMeasures& measures) {
    json object{{"flip", number_or_null(measures.flip)},
                {"psnr_db", number_or_null(measures.psnr_db)},
                {"ssim", number_or_null(measures.ssim)}};
    if (measures.relative_rms) object["relative_rms"] = *measures.relative_rms;
    return object;
}

json comparison_json(const FrameComparison& comparison) {
    json object = measures_json(comparison.whole);
    if (comparison.mask_share) {
        object["inside"] = measures_json(comparison.inside);
        object["outside"] = measures_json(comparison.outside);
        object["inside"]["share"] = *comparison.mask_share;
        if (comparison.outside_plate_psnr_db) object["outside"]["plate_psnr_db"] = *comparison.outside_plate_psnr_db;
    }
    return object;
}

std::string cell(const char* format, const std::optional<double>& value) {
    return value ? fmt::format(fmt::runtime(format), *value) : std::string("-");
}

std::string measures_text(const ErrorMeasures& measures) {
    std::string text = fmt::format("{:>9}{:>8}{:>9}", cell("{:.6f}", measures.flip), cell("{:.2f}", measures.psnr_db),
                                   cell("{:.5f}", measures.ssim));
    if (measures.relative_rms) text += fmt::format("{:>10}", cell("{:.6f}", measures.relative_rms));
    return text;
}

std::string row_text(const std::string& name, const FrameComparison& row) {
    std::string text = fmt::format("{:>6}{}", name, measures_text(row.whole));
    if (row.mask_share) {
        text += fmt::format("  |{:>7}{}  |{}", cell("{:.3f}", row.mask_share), measures_text(row.inside),
                            measures_text(row.outside));
        if (row.outside_plate_psnr_db) text += fmt::format("{:>8}", cell("{:.2f}", row.outside_plate_psnr_db));
    }
    return text + "\n";
}

std::string comparison_text(const std::vector<FrameComparison>& frames, const FrameComparison& mean) {
    const std::string measures =
        std::string("     FLIP    PSNR     SSIM") + (mean.whole.relative_rms ? "   rel.RMS" : "");
    std::string text = " frame" + measures;
    if (mean.mask_share) {
        text +=
            "  | inside" + measures + "  |" + measures + (mean.outside_plate_psnr_db ? " ~plate" : "") + "  (outside)";
    }
    text += "\n";
    for (const FrameComparison& frame : frames) text += row_text(std::to_string(frame.frame), frame);
    return text + row_text("mean", mean);
}

void run_compare(const CompareOptions& options, CommandContext& context) {
    const std::vector<FrameComparison> frames = Comparer(options, context).run();
    const FrameComparison mean = mean_comparison(frames);
    json result{{"reference", options.reference.string()},
                {"test", options.test.string()},
                {"pixels_per_degree", options.flip.pixels_per_degree},
                {"mean", comparison_json(mean)},
                {"frames", json::array()}};
    for (const FrameComparison& frame : frames) {
        json object = comparison_json(frame);
        object["frame"] = frame.frame;
        result["frames"].push_back(std::move(object));
    }
    print_result(context, result, comparison_text(frames, mean));
}

}  // namespace

void add_compare_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("compare", "FLIP, PSNR and SSIM of pictures, sequences or videos");
    const auto options = std::make_shared<CompareOptions>();
    command->add_option("REFERENCE", options->reference, "Picture, sequence (truth_%03d.png) or video")->required();
    command->add_option("TEST", options->test, "Picture, sequence or video to compare with it")->required();
    CLI::Option* mask = command->add_option("--mask", options->mask,
                                            "Picture or sequence, non-zero inside: measure inside and outside apart");
    command
        ->add_option(
            "--region", options->region_plate,
            "The plate: measure apart where REFERENCE differs from it by more than 10 codes (5x5 median, grown "
            "by 15x15); outside, TEST is held against the plate too")
        ->excludes(mask);
    command->add_option("--flip-map", options->flip_map,
                        "Write the FLIP error as picture (magma): map.png or map_%04d.png");
    add_frames_option(*command, options->frames);
    command->add_option("--first-reference", options->first_reference,
                        "The number in the names of REFERENCE's sequence that is frame 0 (default 0)");
    command->add_option("--first-test", options->first_test, "The same for TEST");
    command
        ->add_option("--ppd", options->flip.pixels_per_degree,
                     "Pixels per degree of the viewer (default 67.02: 3840 pixels on 0.7 m seen from 0.7 m)")
        ->check([](const std::string& text) -> std::string {
            // CLI::Range lets NaN pass.
            double value = 0;
            const bool in_range = CLI::detail::lexical_cast(text, value) &&
                                  value >= FlipOptions::smallest_pixels_per_degree &&
                                  value <= FlipOptions::largest_pixels_per_degree;
            return in_range ? std::string() : "'" + text + "' is not between 1 and 1000";
        });
    command->add_flag("--strict", options->strict, "Frames without a partner and damaged videos are errors");
    command->add_flag("--overwrite", options->overwrite, "Replace FLIP maps that exist");
    command->footer(
        fmt::format("Frames are paired by number: sequences by their names, videos from 0. PSNR and SSIM are of "
                    "8-bit codes; PSNR ends at {:.0f} dB, which identical pictures have.",
                    psnr_cap_db));
    command->callback([options, &context] { run_compare(*options, context); });
}

}  // namespace matchlight
