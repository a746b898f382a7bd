// Columns of fixed width; the reasons, which are of any length, come last.
#include "render/pass_table.h"

#include <fmt/format.h>

namespace matchlight {

std::string pass_table(std::span<const PassReport> reports) {
    std::string text =
        fmt::format("{:<28} {:<8} {:>19} {:>9} {:>9} {:>7}  why", "pass", "", "region", "ms", "MB", "bounds");
    for (const PassReport& report : reports) {
        const Region& region = report.frame_pixels;
        const std::string place =
            region.empty() ? "" : fmt::format("{}×{} at {},{}", region.width, region.height, region.x, region.y);
        text += fmt::format("\n{:<28} {:<8} {:>19} ", report.name, report.drawn ? "drawn" : "left out", place);
        text += report.drawn ? fmt::format("{:9.2f} {:9.2f} {:7.1f}  {}", report.ms, report.bytes * 1e-6,
                                           report.bandwidth_bounds, report.why)
                             : fmt::format("{:>9} {:>9} {:>7}  {}", "", "", "", report.why);
    }
    return text;
}

}  // namespace matchlight
