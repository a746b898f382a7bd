// The folder that a report is written to: all of its files or none.
#pragma once

#include <filesystem>
#include <optional>

#include "core/atomic_file.h"
#include "report/report.h"

namespace matchlight {

class ReportFolder {
public:
    /// Makes the folder where it is not there yet, and holds it for this run. Throws InputError: its parent does not
    /// exist, it is not writable, a report is in it already (unless `overwrite`).
    ReportFolder(std::filesystem::path folder, bool overwrite);
    /// Takes a folder that it made away again when nothing was written.
    ~ReportFolder();
    ReportFolder(const ReportFolder&) = delete;
    ReportFolder& operator=(const ReportFolder&) = delete;

    /// report.html, report.csv and report.json. Throws InputError.
    void write(const Report& report) const;

    std::filesystem::path page() const { return folder_ / "report.html"; }

private:
    std::filesystem::path folder_;
    bool made_ = false;
    std::optional<OutputLock> lock_;
};

}  // namespace matchlight
