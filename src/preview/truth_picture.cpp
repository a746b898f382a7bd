// Of a folder, the first name in order whose digits at the end are the frame's number.
#include "preview/truth_picture.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <utility>

#include "core/error.h"
#include "media/image_io.h"

namespace matchlight {

namespace {

namespace fs = std::filesystem;

std::optional<std::int64_t> number_at_end(const std::string& stem) {
    const std::size_t digits = stem.find_last_not_of("0123456789") + 1;
    std::int64_t number = 0;
    const char* const end = stem.data() + stem.size();
    const auto read = std::from_chars(stem.data() + digits, end, number);
    if (digits == stem.size() || read.ec != std::errc()) return std::nullopt;
    return number;
}

}  // namespace

void check_truth(const fs::path& truth) {
    if (!is_pattern(truth) && !fs::exists(truth)) {
        throw InputError(truth, "there is no such picture or folder",
                         "name a picture, a pattern such as truth_%03d.png, "
                         "or a folder of pictures that end in numbers");
    }
}

TruthPictures::TruthPictures(fs::path truth) : truth_(std::move(truth)) {
    is_folder_ = !is_pattern(truth_) && fs::is_directory(truth_);
    if (!is_folder_) return;
    for (const fs::directory_entry& entry : fs::directory_iterator(truth_)) {
        const std::string extension = entry.path().extension().string();
        const bool is_picture =
            extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".tif";
        const std::optional<std::int64_t> number = number_at_end(entry.path().stem().string());
        if (!is_picture || !number) continue;
        const auto [known, is_new] = files_.emplace(*number, entry.path());
        if (!is_new) known->second = std::min(known->second, entry.path());
    }
}

std::optional<Image8> TruthPictures::of_frame(std::int64_t frame) const {
    if (is_folder_) {
        const auto file = files_.find(frame);
        return file == files_.end() ? std::nullopt : std::optional(read_rgb8(file->second));
    }
    const fs::path file = is_pattern(truth_) ? numbered(truth_, frame) : truth_;
    if (is_pattern(truth_) && !fs::exists(file)) return std::nullopt;
    return read_rgb8(file);
}

}  // namespace matchlight
