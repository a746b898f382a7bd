// The names of a report's files.
#include "report/report_folder.h"

namespace matchlight {

ReportFolder::ReportFolder(const std::filesystem::path& folder, bool overwrite)
    : files_(folder, {"report.html", "report.csv", "report.json"}, overwrite) {}

void ReportFolder::write(const Report& report) const {
    files_.write({report_html(report), report_csv(report), report_json(report)});
}

}  // namespace matchlight
