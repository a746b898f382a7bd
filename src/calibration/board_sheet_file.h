// Printed sheets as files: PDF, SVG and PNG by cairo.
#pragma once

#include <filesystem>
#include <vector>

#include "calibration/board_sheet.h"

namespace matchlight {

enum class SheetFormat { pdf, svg, png };
/// By the name's ending. Throws InputError.
SheetFormat sheet_format_of(const std::filesystem::path& path);

/// The files that `path` stands for: a PDF holds all pages; of SVG and PNG there is one a page, by the numbers in a
/// name such as tags_%02d.svg. Throws InputError where several pages have but one name.
std::vector<std::filesystem::path> sheet_files(const BoardSheet& sheet, const std::filesystem::path& path);

/// Writes them. `dpi` counts a PNG's pixels in an inch. Throws InputError: also where a PNG would be absurdly large.
void write_sheet(const BoardSheet& sheet, const std::filesystem::path& path, double dpi);

}  // namespace matchlight
