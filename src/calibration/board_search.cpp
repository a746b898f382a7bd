// Reads pictures on all cores and keeps only the corners.
#include "calibration/board_search.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <glob.h>

#include "calibration/board_detector.h"
#include "calibration/view_choice.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/stop.h"
#include "media/frame_source.h"
#include "media/image_io.h"
#include "media/picture_format.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

bool is_picture(const fs::path& path) {
    try {
        (void)recognise_picture(path);
        return true;
    } catch (const InputError&) {
        return false;
    }
}

std::vector<fs::path> pictures_of_folder(const fs::path& folder) {
    std::vector<fs::path> paths;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        if (entry->is_regular_file(error) && is_picture(entry->path())) paths.push_back(entry->path());
    }
    if (error) throw InputError(folder, "cannot be read (" + error.message() + ")");
    if (paths.empty()) throw InputError(folder, "holds no pictures", "name a folder of PNG or JPEG photographs");
    std::ranges::sort(paths);
    return paths;
}

std::vector<fs::path> pictures_of_glob(const fs::path& pattern) {
    glob_t found{};
    std::vector<fs::path> paths;
    if (glob(pattern.c_str(), 0, nullptr, &found) == 0) {
        for (std::size_t i = 0; i < found.gl_pathc; ++i) paths.emplace_back(found.gl_pathv[i]);
    }
    globfree(&found);
    if (paths.empty()) throw InputError(pattern, "no file has a name of this pattern");
    return paths;
}

/// The photographs that the inputs name; empty for a video.
std::vector<fs::path> photographs_of(const std::vector<fs::path>& inputs) {
    if (inputs.size() != 1) return inputs;
    const fs::path& input = inputs.front();
    std::error_code error;
    if (fs::is_directory(input, error)) return pictures_of_folder(input);
    if (!fs::exists(input, error)) {
        if (is_pattern(input)) {
            std::vector<fs::path> paths;
            for (const std::int64_t number : numbers_of_pattern(input)) paths.push_back(numbered(input, number));
            if (paths.empty()) throw InputError(input, "no file has a name of this pattern");
            return paths;
        }
        if (input.string().find_first_of("*?[") != std::string::npos) return pictures_of_glob(input);
        throw InputError(input, "does not exist", "name photographs, a folder of them, or a video");
    }
    return is_picture(input) ? inputs : std::vector<fs::path>();
}

int lanes() {
    return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

[[noreturn]] void fail_without_board(const fs::path& input, const BoardSpec& board, std::int64_t looked_at,
                                     const char* what, const std::string& seen) {
    throw InputError(input,
                     fmt::format("none of {} {} shows {}{}", looked_at, what, board_text(board),
                                 seen.empty() ? std::string() : "; what is seen: " + printable(seen)),
                     "check --board: it counts inner corners of a chessboard, squares of a ChArUco board");
}

BoardSearch search_photographs(const BoardSpec& board, const std::vector<fs::path>& paths,
                               const BoardSearchOptions& options, Warnings& warnings) {
    std::vector<BoardSighting> sightings(paths.size());
    std::vector<std::pair<int, int>> sizes(paths.size());
    Progress progress("looking for the board", static_cast<std::int64_t>(paths.size()), options.quiet);
    std::mutex progress_mutex;
    std::atomic<std::size_t> next = 0;
    parallel_for(lanes(), [&](int) {
        const std::unique_ptr<BoardDetector> detector = BoardDetector::create(board);
        for (std::size_t i = next++; i < paths.size(); i = next++) {
            if (stop_requested()) throw InputError(paths[i], "stopped on request");
            const Image8 rgb = read_rgb8(paths[i]);
            sizes[i] = {rgb.width(), rgb.height()};
            const BoardPicture picture = board_picture(rgb);
            sightings[i] = detector->detect(picture);
            if (options.as_opencv) measure_as_opencv(picture, sightings[i]);
            const std::lock_guard lock(progress_mutex);
            progress.advance();
        }
    });
    for (std::size_t i = 1; i < paths.size(); ++i) {
        if (sizes[i] == sizes[0]) continue;
        throw InputError(paths[i],
                         fmt::format("is {}×{}, but {} is {}×{}", sizes[i].first, sizes[i].second,
                                     printable(paths[0].filename().string()), sizes[0].first, sizes[0].second),
                         "a lens is calibrated at one size; give photographs of one camera, all held the same way");
    }
    BoardSearch search;
    search.data = {board, sizes[0].first, sizes[0].second, {}};
    search.looked_at = static_cast<std::int64_t>(paths.size());
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const std::string name = paths[i].filename().string();
        if (sightings[i].corners.empty()) {
            search.without_board.push_back(name);
            continue;
        }
        search.data.views.push_back({name, static_cast<std::int64_t>(i), std::move(sightings[i].corners)});
    }
    search.with_board = static_cast<std::int64_t>(search.data.views.size());
    if (search.data.views.empty()) {
        const std::unique_ptr<BoardDetector> detector = BoardDetector::create(board);
        fail_without_board(options.inputs.front(), board, search.looked_at,
                           paths.size() == 1 ? "photograph" : "photographs",
                           detector->seen_instead(board_picture(read_rgb8(paths[paths.size() / 2]))));
    }
    for (const std::string& name : search.without_board) {
        warnings.add(fmt::format("{}: the board was not found", printable(name)));
    }
    return search;
}

/// Calls `use` with every `step`th frame, on all cores; which core gets which frame makes no difference.
template <class Use>
void for_frames(FrameSource& source, std::int64_t step, const Use& use) {
    std::mutex source_mutex;
    bool ended = false;
    parallel_for(lanes(), [&](int) {
        use([&]() -> std::optional<PlateFrame> {
            const std::lock_guard lock(source_mutex);
            while (!ended) {
                ended = true;  // also when decoding throws: the other threads stop
                if (stop_requested()) throw InputError(source.info().path, "stopped on request");
                std::optional<PlateFrame> frame = source.next();
                ended = !frame;
                if (frame && frame->index() % step == 0) return frame;
            }
            return std::nullopt;
        });
    });
}

BoardSearch search_video(const BoardSpec& board, const BoardSearchOptions& options, Warnings& warnings) {
    const fs::path& path = options.inputs.front();
    FootageOptions footage;
    footage.strict = options.strict;
    const std::unique_ptr<FrameSource> source = FrameSource::open(path, footage, warnings);
    const FootageInfo& info = source->info();
    // A hand moves little from frame to frame: of long videos some hundred frames hold all there is to choose from.
    constexpr std::int64_t enough_frames = 400;
    const std::int64_t step = std::max<std::int64_t>(1, info.frame_count / enough_frames);
    std::map<std::int64_t, BoardSighting> sightings;
    std::mutex sightings_mutex;
    {
        Progress progress("looking for the board", (info.frame_count + step - 1) / step, options.quiet);
        for_frames(*source, step, [&](const auto& take) {
            const std::unique_ptr<BoardDetector> detector = BoardDetector::create(board);
            while (const std::optional<PlateFrame> frame = take()) {
                const Region whole{0, 0, frame->format().width, frame->format().height};
                const BoardPicture picture = board_picture(frame->gray_code(whole));
                BoardSighting sighting = detector->detect(picture);
                if (options.as_opencv) measure_as_opencv(picture, sighting);
                const std::lock_guard lock(sightings_mutex);
                sightings.emplace(frame->index(), std::move(sighting));
                progress.advance();
            }
        });
    }
    BoardSearch search;
    search.is_video = true;
    search.data = {board, info.format.width, info.format.height, {}};
    search.looked_at = static_cast<std::int64_t>(sightings.size());
    for (auto& [frame, sighting] : sightings) {
        if (sighting.corners.empty()) continue;
        search.data.views.push_back({fmt::format("frame {}", frame), frame, std::move(sighting.corners)});
    }
    search.with_board = static_cast<std::int64_t>(search.data.views.size());
    if (search.data.views.empty()) {
        source->seek(info.frame_count / 2);
        const std::optional<PlateFrame> frame = source->next();
        const std::unique_ptr<BoardDetector> detector = BoardDetector::create(board);
        fail_without_board(path, board, search.looked_at, "frames",
                           frame ? detector->seen_instead(board_picture(
                                       frame->gray_code({0, 0, frame->format().width, frame->format().height})))
                                 : std::string());
    }
    return search;
}

}  // namespace

BoardSearch find_boards(const BoardSpec& board, const BoardSearchOptions& options, Warnings& warnings) {
    const std::vector<fs::path> photographs = photographs_of(options.inputs);
    const bool video = photographs.empty();
    BoardSearch search =
        video ? search_video(board, options, warnings) : search_photographs(board, photographs, options, warnings);
    constexpr std::size_t of_a_video = 40;  // more add little; the adjustment's time grows with them
    const std::size_t most = options.most_views.value_or(video ? of_a_video : search.data.views.size());
    if (most < search.data.views.size()) {
        std::vector<LensView> chosen;
        for (const std::size_t v : choose_views(search.data, most)) chosen.push_back(std::move(search.data.views[v]));
        search.data.views = std::move(chosen);
    }
    return search;
}

}  // namespace matchlight
