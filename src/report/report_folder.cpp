// Writes every file under a temporary name before the first gets its own.
#include "report/report_folder.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/error.h"

namespace matchlight {

namespace fs = std::filesystem;

ReportFolder::ReportFolder(fs::path folder, bool overwrite) : folder_(std::move(folder)) {
    std::error_code error;
    if (fs::exists(folder_, error) && !fs::is_directory(folder_, error)) {
        throw InputError(folder_, "is not a folder", "name the folder that the report goes to");
    }
    if (!fs::is_directory(folder_, error)) {
        made_ = fs::create_directory(folder_, error);
        if (error) throw InputError(folder_, "cannot be made: " + error.message(), "make the folder above it first");
    }
    try {
        for (const char* name : {"report.html", "report.csv", "report.json"}) check_output(folder_ / name, overwrite);
        lock_.emplace(folder_ / "report.json");
    } catch (const InputError&) {
        if (made_) fs::remove(folder_, error);
        throw;
    }
}

ReportFolder::~ReportFolder() {
    lock_.reset();
    std::error_code ignored;
    // Only an empty folder goes: fs::remove leaves others.
    if (made_) fs::remove(folder_, ignored);
}

void ReportFolder::write(const Report& report) const {
    const std::array<std::pair<const char*, std::string>, 3> files{{{"report.html", report_html(report)},
                                                                    {"report.csv", report_csv(report)},
                                                                    {"report.json", report_json(report)}}};
    std::vector<PendingFile> pending;
    for (const auto& [name, text] : files) {
        const PendingFile& file = pending.emplace_back(folder_ / name);
        std::ofstream stream(file.path(), std::ios::binary | std::ios::trunc);
        stream.write(text.data(), static_cast<std::streamsize>(text.size()));
        stream.close();
        if (!stream) throw InputError(file.final_path(), std::string("cannot be written: ") + std::strerror(errno));
    }
    for (PendingFile& file : pending) file.commit();
}

}  // namespace matchlight
