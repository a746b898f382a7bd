// Writes every file under a temporary name before the first gets its own.
#include "core/output_folder.h"

#include <cassert>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "core/error.h"

namespace matchlight {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(fs::path folder, std::vector<std::string> names, bool overwrite)
    : folder_(std::move(folder)), names_(std::move(names)) {
    assert(!names_.empty());
    std::error_code error;
    if (fs::exists(folder_, error) && !fs::is_directory(folder_, error)) {
        throw InputError(folder_, "is not a folder", "name the folder that the files go to");
    }
    if (!fs::is_directory(folder_, error)) {
        made_ = fs::create_directory(folder_, error);
        if (error) throw InputError(folder_, "cannot be made: " + error.message(), "make the folder above it first");
    }
    try {
        for (const std::string& name : names_) check_output(folder_ / name, overwrite);
        lock_.emplace(folder_ / names_.back());
    } catch (const InputError&) {
        if (made_) fs::remove(folder_, error);
        throw;
    }
}

OutputFolder::~OutputFolder() {
    lock_.reset();
    std::error_code ignored;
    // Only an empty folder goes: fs::remove leaves others.
    if (made_) fs::remove(folder_, ignored);
}

void OutputFolder::write(const std::vector<std::string>& texts) const {
    assert(texts.size() == names_.size());
    std::vector<PendingFile> pending;
    for (std::size_t i = 0; i < texts.size(); ++i) {
        const PendingFile& file = pending.emplace_back(folder_ / names_[i]);
        std::ofstream stream(file.path(), std::ios::binary | std::ios::trunc);
        stream.write(texts[i].data(), static_cast<std::streamsize>(texts[i].size()));
        stream.close();
        if (!stream) throw InputError(file.final_path(), std::string("cannot be written: ") + std::strerror(errno));
    }
    for (PendingFile& file : pending) file.commit();
}

}  // namespace matchlight
