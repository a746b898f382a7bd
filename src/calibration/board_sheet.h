// Boards and tags as they are printed: their ink on a page of paper, in millimetres, true to size.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/board.h"

namespace matchlight {

/// A sheet of paper as it lies before the reader.
struct Paper {
    std::string name;  // "a4", or as the user gave it: "300x400mm"
    double width_mm = 0, height_mm = 0;
    bool may_turn = true;  // landscape where that fits better; not where the user gave width and height
};
/// "a0" to "a6", "letter", "legal", "tabloid", or "300x400mm". Throws InputError.
Paper read_paper(const std::string& text);
extern const char* const paper_forms;

/// A closed line on the page: millimetres, x to the right and y down from the upper left corner of the paper.
using InkOutline = std::vector<Eigen::Vector2d>;
/// Black areas, filled by the even-odd rule. Cells that touch are one area, so that no hairline shows between them.
using InkShape = std::vector<InkOutline>;

/// Small print, which does not need to be exact.
struct SheetText {
    std::string text;
    Eigen::Vector2d at_mm;     // on the base line: the text's left end, or its middle
    double height_mm = 0;      // of the font
    double most_width_mm = 0;  // longer texts are set smaller
    bool centred = false;
};

struct PrintedTag {
    int id = 0;
    Eigen::Vector2d middle_mm;
};

struct SheetPage {
    std::vector<InkShape> ink;
    std::vector<SheetText> texts;
    std::vector<PrintedTag> tags;             // of a sheet of tags
    std::vector<Eigen::Vector2d> corners_mm;  // where board_corners_m are; of tags four each, from the lower left
};

struct BoardSheet {
    Paper paper;  // turned as it is printed
    std::string title;
    std::vector<SheetPage> pages;  // at least one
};

/// The board on one page, with a ruler to check the print by. Throws InputError where the paper is too small, naming
/// one that is not.
BoardSheet board_sheet(const BoardSpec& board, const Paper& paper);

/// AprilTags to be cut out or used as they lie.
struct TagSheetSpec {
    std::string family = "tag36h11";
    std::vector<int> ids;
    double size_m = 0;  // between detection corners (tag36h11: side of the black border)
};
extern const char* const tag_sheet_form;
/// Whether the text speaks of tags rather than of a board.
bool names_tags(const std::string& text);
/// "tags tag36h11 0-5,8 0.08". Throws InputError: unknown family, ids that it does not have, a size that no tag has.
TagSheetSpec read_tag_sheet(const std::string& text);
/// As many tags on a page as fit, or `most_per_page`, with white paper around each. Throws as board_sheet does.
BoardSheet tag_sheet(const TagSheetSpec& spec, const Paper& paper, int most_per_page);
/// The lines of a scene file for the tags: those of one page with their places on it, x to the right and y to the
/// top of the sheet, from the middle of its lowest id.
std::string rig_text(const TagSheetSpec& spec, const BoardSheet& sheet);

}  // namespace matchlight
