// One drawing of a page, in millimetres, on each of cairo's surfaces.
#include "calibration/board_sheet_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/lowercase.h"
#include "core/version.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

constexpr double mm_per_inch = 25.4, points_per_inch = 72;

struct DestroySurface {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct DestroyContext {
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, DestroySurface>;
using Context = std::unique_ptr<cairo_t, DestroyContext>;

void require(cairo_status_t status, const fs::path& path) {
    if (status == CAIRO_STATUS_SUCCESS) return;
    throw InputError(path, std::string("cannot be drawn: ") + cairo_status_to_string(status));
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

void draw_text(cairo_t* context, const SheetText& text) {
    cairo_set_font_size(context, text.height_mm);
    cairo_text_extents_t extents;
    cairo_text_extents(context, text.text.c_str(), &extents);
    if (extents.x_advance > text.most_width_mm) {
        cairo_set_font_size(context, text.height_mm * text.most_width_mm / extents.x_advance);
        cairo_text_extents(context, text.text.c_str(), &extents);
    }
    cairo_move_to(context, text.at_mm.x() - (text.centred ? extents.x_advance / 2 : 0), text.at_mm.y());
    cairo_show_text(context, text.text.c_str());
}

/// The context's unit is a millimetre.
void draw_page(cairo_t* context, const SheetPage& page) {
    cairo_set_fill_rule(context, CAIRO_FILL_RULE_EVEN_ODD);
    for (const InkShape& shape : page.ink) {
        for (const InkOutline& outline : shape) {
            cairo_new_sub_path(context);
            for (const Eigen::Vector2d& at : outline) cairo_line_to(context, at.x(), at.y());
            cairo_close_path(context);
        }
        cairo_fill(context);
    }
    cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    for (const SheetText& text : page.texts) draw_text(context, text);
}

std::string pdf_of(const BoardSheet& sheet, const fs::path& path) {
    std::string bytes;
    constexpr double scale = points_per_inch / mm_per_inch;
    const Surface surface(cairo_pdf_surface_create_for_stream(append, &bytes, sheet.paper.width_mm * scale,
                                                              sheet.paper.height_mm * scale));
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, sheet.title.c_str());
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR,
                                   (std::string("matchlight ") + version).c_str());
    const Context context(cairo_create(surface.get()));
    cairo_scale(context.get(), scale, scale);
    for (const SheetPage& page : sheet.pages) {
        draw_page(context.get(), page);
        cairo_show_page(context.get());
    }
    require(cairo_status(context.get()), path);
    cairo_surface_finish(surface.get());
    require(cairo_surface_status(surface.get()), path);
    return bytes;
}

std::string svg_of(const BoardSheet& sheet, const SheetPage& page, const fs::path& path) {
    std::string bytes;
    const Surface surface(
        cairo_svg_surface_create_for_stream(append, &bytes, sheet.paper.width_mm, sheet.paper.height_mm));
    cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_MM);
    const Context context(cairo_create(surface.get()));
    // White paper: programs that show an SVG on grey or black would hide the margin that detectors need.
    cairo_set_source_rgb(context.get(), 1, 1, 1);
    cairo_paint(context.get());
    cairo_set_source_rgb(context.get(), 0, 0, 0);
    draw_page(context.get(), page);
    require(cairo_status(context.get()), path);
    cairo_surface_finish(surface.get());
    require(cairo_surface_status(surface.get()), path);
    return bytes;
}

int pixels_of(double mm, double dpi) {
    return static_cast<int>(std::lround(mm / mm_per_inch * dpi));
}

/// A pixel of the edge is as dark as ink covers it, in code values: detectors find an edge where it is half.
Image8 picture_of(const BoardSheet& sheet, const SheetPage& page, double dpi, const fs::path& path) {
    const int width = pixels_of(sheet.paper.width_mm, dpi), height = pixels_of(sheet.paper.height_mm, dpi);
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_A8, width, height));
    require(cairo_surface_status(surface.get()), path);
    const Context context(cairo_create(surface.get()));
    cairo_scale(context.get(), dpi / mm_per_inch, dpi / mm_per_inch);
    draw_page(context.get(), page);
    require(cairo_status(context.get()), path);
    cairo_surface_flush(surface.get());
    const unsigned char* ink = cairo_image_surface_get_data(surface.get());
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
    Image8 picture(width, height, 1);
    for (int y = 0; y < height; ++y) {
        const unsigned char* row = ink + static_cast<std::size_t>(y) * stride;
        std::transform(row, row + width, picture.pixel(0, y),
                       [](unsigned char cover) { return static_cast<std::uint8_t>(255 - cover); });
    }
    return picture;
}

void require_reasonable(const BoardSheet& sheet, double dpi, const fs::path& path) {
    // cairo's own limit of a side, and a gigabyte for the drawing and its copies.
    constexpr double most_side = 32767, most_pixels = 3e8;
    const double width = sheet.paper.width_mm / mm_per_inch * dpi, height = sheet.paper.height_mm / mm_per_inch * dpi;
    if (std::max(width, height) <= most_side && width * height <= most_pixels) return;
    throw InputError(path, fmt::format("would have {:.0f} × {:.0f} pixels at {:.4g} dpi", width, height, dpi),
                     "lower --dpi, or write .pdf or .svg");
}

}  // namespace

SheetFormat sheet_format_of(const fs::path& path) {
    const std::string extension = lowercase_extension(path);
    if (extension == ".pdf") return SheetFormat::pdf;
    if (extension == ".svg") return SheetFormat::svg;
    if (extension == ".png") return SheetFormat::png;
    throw InputError(path, "is no kind of file that a sheet is written to", "end its name in .pdf, .svg or .png");
}

std::vector<fs::path> sheet_files(const BoardSheet& sheet, const fs::path& path) {
    if (sheet_format_of(path) == SheetFormat::pdf) return {path};
    if (!is_pattern(path)) {
        if (sheet.pages.size() == 1) return {path};
        throw InputError(path, fmt::format("the sheet has {} pages", sheet.pages.size()),
                         "write a .pdf, or number the pages by a name such as sheet_%02d" + path.extension().string());
    }
    std::vector<fs::path> files;
    for (std::size_t i = 0; i < sheet.pages.size(); ++i) {
        files.push_back(numbered(path, static_cast<std::int64_t>(i) + 1));
    }
    return files;
}

void write_sheet(const BoardSheet& sheet, const fs::path& path, double dpi) {
    const std::vector<fs::path> files = sheet_files(sheet, path);
    const SheetFormat format = sheet_format_of(path);
    if (format == SheetFormat::pdf) {
        write_text_file(path, pdf_of(sheet, path));
        return;
    }
    if (format == SheetFormat::png) require_reasonable(sheet, dpi, path);
    for (std::size_t i = 0; i < files.size(); ++i) {
        const SheetPage& page = sheet.pages[i];
        if (format == SheetFormat::svg) {
            write_text_file(files[i], svg_of(sheet, page, files[i]));
        } else {
            write_png8(files[i], picture_of(sheet, page, dpi, files[i]),
                       {{"software", std::string("matchlight ") + version}, {"ImageDescription", sheet.title}}, dpi);
        }
    }
}

}  // namespace matchlight
