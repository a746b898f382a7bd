// matchlight board: tags and calibration boards to print, true to size.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "calibration/board_sheet.h"
#include "calibration/board_sheet_file.h"
#include "commands/command.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct BoardCall {
    std::vector<std::string> words;
    fs::path output;
    std::string paper = "a4";
    int per_page = 0;  // as many as fit
    double dpi = 300;
    bool overwrite = false;
};

json pages_json(const BoardSheet& sheet) {
    json pages = json::array();
    for (const SheetPage& page : sheet.pages) {
        json entry{{"corners_mm", json::array()}};
        for (const Eigen::Vector2d& corner : page.corners_mm) entry["corners_mm"].push_back({corner.x(), corner.y()});
        for (const PrintedTag& tag : page.tags) {
            entry["tags"].push_back({{"id", tag.id}, {"middle_mm", {tag.middle_mm.x(), tag.middle_mm.y()}}});
        }
        pages.push_back(entry);
    }
    return pages;
}

void run_board(const BoardCall& call, CommandContext& context) {
    const std::string spec = fmt::format("{}", fmt::join(call.words, " "));
    const Paper paper = read_paper(call.paper);
    const bool tags = names_tags(spec);
    TagSheetSpec tag_spec;
    if (tags) tag_spec = read_tag_sheet(spec);
    if (!tags && call.per_page > 0) {
        throw CLI::ValidationError("--per-page", "is for tags; a board has a page of its own");
    }
    const BoardSheet sheet = tags ? tag_sheet(tag_spec, paper, call.per_page) : board_sheet(read_board(spec), paper);
    const std::vector<fs::path> files = sheet_files(sheet, call.output);
    for (const fs::path& file : files) check_output(file, call.overwrite);
    const OutputLock lock(call.output);
    write_sheet(sheet, call.output, call.dpi);

    json result{{"title", sheet.title},
                {"paper", sheet.paper.name},
                {"width_mm", sheet.paper.width_mm},
                {"height_mm", sheet.paper.height_mm},
                {"pages", pages_json(sheet)},
                {"files", json::array()}};
    for (const fs::path& file : files) result["files"].push_back(file.string());
    std::string text = fmt::format("{}: {}; {} page{} of {:.4g} × {:.4g} mm ({})\n", call.output.string(), sheet.title,
                                   sheet.pages.size(), sheet.pages.size() == 1 ? "" : "s", sheet.paper.width_mm,
                                   sheet.paper.height_mm, sheet.paper.name);
    text += "print at 100 %, not fitted to the page, and measure the ruler\n";
    if (tags) {
        const std::string rig = rig_text(tag_spec, sheet);
        result["rig"] = rig;
        text += "for the scene file, where the sheet lies flat and uncut:\n\n" + rig;
    } else {
        text += fmt::format("photograph it, then: matchlight calibrate PHOTOS --board \"{}\" -o camera.yaml\n", spec);
    }
    print_result(context, result, text);
}

/// CLI::Range lets NaN pass.
CLI::Validator resolution() {
    return {[](const std::string& text) {
                double value = 0;
                constexpr double least = 36, most = 4800;  // a screen's half, the finest printers'
                const bool fine = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
                return fine ? std::string() : fmt::format("'{}' is not between {} and {}", text, least, most);
            },
            ""};
}

}  // namespace

void add_board_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("board", "Tags and calibration boards to print, true to size");
    const auto call = std::make_shared<BoardCall>();
    command
        ->add_option("SPEC", call->words,
                     std::string("What to print: ") + tag_sheet_form +
                         ", or a board as `calibrate` takes it: " + board_spec_forms)
        ->required();
    command
        ->add_option("-o,--output", call->output,
                     "Where to write: .pdf, .svg or .png; pages of the latter two by a name such as tags_%02d.svg")
        ->required();
    command->add_option("--paper", call->paper, std::string("What it is printed on (default: a4): ") + paper_forms)
        ->type_name("SIZE");
    command->add_option("--per-page", call->per_page, "At most so many tags on a page (default: as many as fit)")
        ->check(CLI::Range(1, 1000).description(""))
        ->type_name("COUNT");
    command->add_option("--dpi", call->dpi, "Pixels in an inch of a PNG (default: 300)")
        ->check(resolution())
        ->type_name("NUMBER");
    command->add_flag("--overwrite", call->overwrite, "Replace files that exist");
    command->callback([call, &context] { run_board(*call, context); });
}

}  // namespace matchlight
