// Of a folder, the first name in order whose digits at the end are the frame's number.
#include "preview/truth_picture.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <vector>

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

std::optional<fs::path> picture_in_folder(const fs::path& folder, std::int64_t frame) {
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string extension = entry.path().extension().string();
        const bool is_picture =
            extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".tif";
        if (is_picture && number_at_end(entry.path().stem().string()) == frame) found.push_back(entry.path());
    }
    if (found.empty()) return std::nullopt;
    return *std::ranges::min_element(found);
}

}  // namespace

void check_truth(const fs::path& truth) {
    if (!is_pattern(truth) && !fs::exists(truth)) {
        throw InputError(truth, "there is no such picture or folder",
                         "name a picture, a pattern such as truth_%03d.png, "
                         "or a folder of pictures that end in numbers");
    }
}

std::optional<Image8> truth_picture(const fs::path& truth, std::int64_t frame) {
    if (truth.empty()) return std::nullopt;
    fs::path file = truth;
    if (is_pattern(truth)) {
        file = numbered(truth, frame);
        if (!fs::exists(file)) return std::nullopt;
    } else if (fs::is_directory(truth)) {
        const std::optional<fs::path> found = picture_in_folder(truth, frame);
        if (!found) return std::nullopt;
        file = *found;
    }
    return read_rgb8(file);
}

}  // namespace matchlight
