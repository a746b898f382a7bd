// Temporary names, fsync, rename, and an advisory lock.
#include "core/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"

namespace matchlight {

namespace fs = std::filesystem;

namespace {

std::string system_reason() {
    return std::strerror(errno);
}

fs::path beside(const fs::path& path) {
    fs::path name = path.stem();
    name += ".part";
    name += path.extension();
    return path.parent_path() / name;
}

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

void sync_path(const fs::path& path, const fs::path& reported) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) throw InputError(reported, "cannot be written: " + system_reason());
    const int status = fsync(descriptor);
    const int reason = errno;
    close(descriptor);
    if (status != 0) {
        errno = reason;
        throw InputError(reported, "cannot be written: " + system_reason(), "free some space on the disk");
    }
}

bool names_open_file(const fs::path& path, int descriptor) {
    struct stat named {};
    struct stat opened {};
    return stat(path.c_str(), &named) == 0 && fstat(descriptor, &opened) == 0 && named.st_dev == opened.st_dev &&
           named.st_ino == opened.st_ino;
}

}  // namespace

PendingFile::PendingFile(fs::path final_path)
    : final_path_(std::move(final_path)), temporary_path_(beside(final_path_)) {}

PendingFile::PendingFile(PendingFile&& other) noexcept
    : final_path_(std::move(other.final_path_)),
      temporary_path_(std::move(other.temporary_path_)),
      pending_(std::exchange(other.pending_, false)) {}

PendingFile::~PendingFile() {
    if (!pending_) return;
    std::error_code ignored;
    fs::remove(temporary_path_, ignored);
}

void PendingFile::commit() {
    sync_path(temporary_path_, final_path_);
    std::error_code error;
    fs::rename(temporary_path_, final_path_, error);
    if (error) throw InputError(final_path_, "cannot be renamed into place: " + error.message());
    pending_ = false;
}

void write_text_file(const fs::path& path, std::string_view text) {
    PendingFile file(path);
    {
        std::ofstream stream(file.path(), std::ios::binary | std::ios::trunc);
        stream.write(text.data(), static_cast<std::streamsize>(text.size()));
        stream.close();
        if (!stream) throw InputError(path, "cannot be written: " + system_reason());
    }
    file.commit();
}

std::string read_text_file(const fs::path& path, std::size_t limit_bytes) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw InputError(path, "no such file");
    if (!fs::is_regular_file(status)) throw InputError(path, "is not a regular file");
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) throw InputError(path, "cannot be read: " + error.message());
    if (size > limit_bytes) throw InputError(path, "is too long for a file of its kind");
    std::ifstream stream(path, std::ios::binary);
    std::string text(size, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(size));
    if (!stream) throw InputError(path, "cannot be read: " + system_reason());
    return text;
}

void check_output(const fs::path& path, bool overwrite) {
    const fs::path folder = folder_of(path);
    std::error_code error;
    if (!fs::is_directory(folder, error)) throw InputError(path, "its folder does not exist", "create it first");
    if (access(folder.c_str(), W_OK | X_OK) != 0) throw InputError(path, "its folder is not writable");
    if (fs::is_directory(path, error)) throw InputError(path, "is a folder", "name a file");
    // A rename would put a file in the place of a device or pipe.
    if (fs::exists(path, error) && !fs::is_regular_file(path, error))
        throw InputError(path, "is not a regular file", "name another output");
    if (fs::exists(path, error) && !overwrite)
        throw InputError(path, "exists already", "use --overwrite to replace it");
}

OutputLock::OutputLock(const fs::path& output)
    : lock_path_(folder_of(output) / ("." + output.filename().string() + ".lock")) {
    while (true) {
        descriptor_ = open(lock_path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor_ < 0) throw InputError(output, "cannot be locked: " + system_reason());
        if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
            close(descriptor_);
            throw InputError(output, "another run is writing it", "wait for that run or name another output");
        }
        // Between open and flock the run before may have removed the name: then this lock is on a file nobody else
        // will ever open, and holds nothing.
        if (names_open_file(lock_path_, descriptor_)) return;
        close(descriptor_);
    }
}

OutputLock::~OutputLock() {
    // Removed while still held, so that no second run can lock a name that is about to vanish unnoticed.
    unlink(lock_path_.c_str());
    close(descriptor_);
}

}  // namespace matchlight
