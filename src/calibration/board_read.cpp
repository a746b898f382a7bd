// Reads what the user says of a board: a short text, a TOML file, or Kalibr's target YAML.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>
#include <toml++/toml.h>

#include "calibration/board.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/lowercase.h"

namespace matchlight {

const char* const board_spec_forms =
    "\"chessboard COLUMNSxROWS SQUARE\" (inner corners), \"charuco COLUMNSxROWS SQUARE MARKER DICT_5X5_100\" "
    "(squares), \"aprilgrid COLUMNSxROWS TAG SPACING\" (Kalibr's; spacing over tag), metres; or a .toml file, or "
    "Kalibr's target .yaml";

namespace {

/// More corners than this no board has; the limit keeps a slip of the pen from asking for absurd buffers.
constexpr int largest_count = 100;
/// A board larger than a house, or a square below a hundredth of a millimetre, is a slip of units.
constexpr double largest_length_m = 100, smallest_length_m = 1e-5;

[[noreturn]] void fail(const std::string& reported, const std::string& cause) {
    throw InputError({}, "the board \"" + printable(reported) + "\": " + cause, std::string("say ") + board_spec_forms);
}

double number_of(const std::string& text, const std::string& reported) {
    double value = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) {
        fail(reported, "\"" + printable(text) + "\" is no number");
    }
    return value;
}

int count_of(double value, const char* what, const std::string& reported) {
    if (!(value >= 1 && value <= largest_count) || value != std::floor(value)) {
        fail(reported, fmt::format("{} must be a whole number from 1 to {}", what, largest_count));
    }
    return static_cast<int>(value);
}

void require_length(double metres, const char* what, const std::string& reported) {
    if (!(metres >= smallest_length_m && metres <= largest_length_m)) {
        fail(reported, fmt::format("{} of {} m is no length of a board (metres)", what, metres));
    }
}

BoardSpec checked(BoardSpec board, const std::string& reported) {
    if (board.kind == BoardKind::aprilgrid) {
        require_length(board.tag_m, "a tag", reported);
        if (!(board.spacing >= 0.05 && board.spacing <= 2)) {
            fail(reported, "the spacing is the gap between tags over the side of a tag, such as 0.3");
        }
        constexpr int ids = 587;  // of tag36h11
        if (board.first_id < 0 || board.first_id + board.columns * board.rows > ids) {
            fail(reported, fmt::format("tag36h11 has ids 0 to {}", ids - 1));
        }
        return board;
    }
    const int least = board.kind == BoardKind::chessboard ? 3 : 2;
    if (board.columns < least || board.rows < least) {
        fail(reported, fmt::format("needs at least {} × {}", least, least));
    }
    if (board.row_square_m == 0) board.row_square_m = board.square_m;
    require_length(board.square_m, "a square", reported);
    require_length(board.row_square_m, "a square", reported);
    if (board.kind == BoardKind::charuco) {
        require_length(board.marker_m, "a marker", reported);
        if (board.marker_m >= board.square_m) fail(reported, "the markers are as large as their squares");
        if (board.dictionary.empty()) fail(reported, "a ChArUco board needs its dictionary");
    }
    return board;
}

std::optional<BoardKind> kind_of(std::string_view text) {
    const std::string name = lowercase(text);
    if (name == "chessboard" || name == "checkerboard") return BoardKind::chessboard;
    if (name == "charuco") return BoardKind::charuco;
    if (name == "aprilgrid") return BoardKind::aprilgrid;
    return std::nullopt;
}

BoardSpec board_of_words(const std::vector<std::string>& words, BoardKind kind, const std::string& text) {
    BoardSpec board;
    board.kind = kind;
    const std::size_t wanted = kind == BoardKind::chessboard ? 3 : kind == BoardKind::charuco ? 5 : 4;
    if (words.size() != wanted) fail(text, fmt::format("has {} words, not {}", words.size(), wanted));
    const std::size_t by = words[1].find('x');
    if (by == std::string::npos) fail(text, "\"" + printable(words[1]) + "\" is no size such as 9x6");
    board.columns = count_of(number_of(words[1].substr(0, by), text), "the number of columns", text);
    board.rows = count_of(number_of(words[1].substr(by + 1), text), "the number of rows", text);
    if (kind == BoardKind::aprilgrid) {
        board.tag_m = number_of(words[2], text);
        board.spacing = number_of(words[3], text);
    } else {
        board.square_m = number_of(words[2], text);
        if (kind == BoardKind::charuco) {
            board.marker_m = number_of(words[3], text);
            board.dictionary = words[4];
        }
    }
    return checked(board, text);
}

BoardSpec board_of_toml(const std::filesystem::path& path, const std::string& text) {
    const std::string reported = path.string();
    toml::table table;
    try {
        table = toml::parse(text, reported);
    } catch (const toml::parse_error& error) {
        throw InputError({path, {}, std::string(error.description()), {}, error.source().begin.line});
    }
    for (const auto& [key, value] : table) {
        constexpr std::string_view known[] = {"type",   "columns",    "rows",     "square",  "row_square",
                                              "marker", "dictionary", "tag_size", "spacing", "first_id"};
        if (std::ranges::find(known, key.str()) == std::end(known)) {
            fail(reported, fmt::format("the key '{}' is not known (type, columns, rows, square, row_square, marker, "
                                       "dictionary, tag_size, spacing, first_id)",
                                       printable(std::string(key.str()))));
        }
    }
    const auto number = [&](const char* key, std::optional<double> absent) {
        const auto node = table[key];
        if (!node && absent) return *absent;
        const std::optional<double> value = node.value<double>();
        if (!value) fail(reported, std::string(key) + " is missing or no number");
        return *value;
    };
    const std::optional<BoardKind> kind = kind_of(table["type"].value_or(std::string()));
    if (!kind) fail(reported, "type is none of chessboard, charuco and aprilgrid");
    BoardSpec board;
    board.kind = *kind;
    board.columns = count_of(number("columns", {}), "columns", reported);
    board.rows = count_of(number("rows", {}), "rows", reported);
    if (board.kind == BoardKind::aprilgrid) {
        board.tag_m = number("tag_size", {});
        board.spacing = number("spacing", {});
        const double first_id = number("first_id", 0);
        if (!(first_id >= 0 && first_id < 587) || first_id != std::floor(first_id)) {
            fail(reported, "first_id is no id of tag36h11");
        }
        board.first_id = static_cast<int>(first_id);
    } else {
        board.square_m = number("square", {});
        board.row_square_m = number("row_square", board.square_m);
        if (board.kind == BoardKind::charuco) {
            board.marker_m = number("marker", {});
            board.dictionary = table["dictionary"].value_or(std::string());
        }
    }
    return checked(board, reported);
}

BoardSpec board_of_kalibr(const std::filesystem::path& path, const std::string& text) {
    const std::string reported = path.string();
    try {
        const cv::FileStorage file("%YAML:1.0\n---\n" + text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
        const auto number = [&](const char* key) {
            const cv::FileNode node = file[key];
            if (!node.isInt() && !node.isReal()) fail(reported, std::string(key) + " is missing or no number");
            return static_cast<double>(node);
        };
        const cv::FileNode type = file["target_type"];
        const std::optional<BoardKind> kind = kind_of(type.isString() ? type.string() : std::string());
        BoardSpec board;
        if (kind == BoardKind::aprilgrid) {
            board.kind = BoardKind::aprilgrid;
            board.columns = count_of(number("tagCols"), "tagCols", reported);
            board.rows = count_of(number("tagRows"), "tagRows", reported);
            board.tag_m = number("tagSize");
            board.spacing = number("tagSpacing");
            return checked(board, reported);
        }
        if (kind == BoardKind::chessboard) {
            board.columns = count_of(number("targetCols"), "targetCols", reported);
            board.rows = count_of(number("targetRows"), "targetRows", reported);
            board.square_m = number("colSpacingMeters");
            board.row_square_m = number("rowSpacingMeters");
            return checked(board, reported);
        }
        fail(reported, "target_type is none of aprilgrid and checkerboard");
    } catch (const cv::Exception& error) {
        fail(reported, "this is no board (" + printable(error.err) + ")");
    }
}

}  // namespace

BoardSpec read_board(const std::string& text_or_path) {
    std::istringstream stream(text_or_path);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty()) fail(text_or_path, "is empty");
    std::error_code error;
    const bool is_file = std::filesystem::exists(text_or_path, error);
    if (const std::optional<BoardKind> kind = kind_of(words[0]); kind && !is_file) {
        return board_of_words(words, *kind, text_or_path);
    }
    if (!is_file && (words[0] == "tags" || words[0] == "tag")) {
        fail(text_or_path, "names tags to print; a lens is calibrated with a board");
    }
    if (!is_file) fail(text_or_path, "is neither a board nor a file");
    constexpr std::size_t limit_bytes = 1u << 20;  // a board is a few lines
    const std::string text = read_text_file(text_or_path, limit_bytes);
    const std::string extension = std::filesystem::path(text_or_path).extension().string();
    if (extension == ".yaml" || extension == ".yml") return board_of_kalibr(text_or_path, text);
    return board_of_toml(text_or_path, text);
}

}  // namespace matchlight
