// The folder that a report is written to: all of its files or none.
#pragma once

#include <filesystem>

#include "core/output_folder.h"
#include "report/report.h"

namespace matchlight {

class ReportFolder {
public:
    /// Holds the folder for this run. Throws InputError as OutputFolder does.
    ReportFolder(const std::filesystem::path& folder, bool overwrite);

    /// report.html, report.csv and report.json. Throws InputError.
    void write(const Report& report) const;

    std::filesystem::path page() const { return files_.path() / "report.html"; }

private:
    OutputFolder files_;
};

}  // namespace matchlight
