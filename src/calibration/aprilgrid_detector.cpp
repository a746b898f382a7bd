// Kalibr's AprilGrid: tag36h11 with a border of two cells, which AprilTag's own families do not know, and small black
// squares in the gaps that touch the tags' corners, so that each corner is a crossing of edges.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "calibration/board_detector.h"
#include "calibration/corner_net.h"
#include "core/transforms.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;

constexpr int border_cells = 2, code_cells = 6, tag_cells = code_cells + 2 * border_cells;

/// The codes of tag36h11 behind a border of two cells instead of one.
struct TwoCellFamily {
    apriltag_family_t* stock = tag36h11_create();
    std::vector<std::uint32_t> bit_x, bit_y;
    apriltag_family_t family = *stock;

    TwoCellFamily()
        : bit_x(stock->bit_x, stock->bit_x + stock->nbits), bit_y(stock->bit_y, stock->bit_y + stock->nbits) {
        for (std::uint32_t& x : bit_x) x += border_cells - 1;
        for (std::uint32_t& y : bit_y) y += border_cells - 1;
        family.bit_x = bit_x.data();
        family.bit_y = bit_y.data();
        family.width_at_border = tag_cells;
        family.total_width = tag_cells + 2;
        family.impl = nullptr;
    }
    ~TwoCellFamily() { tag36h11_destroy(stock); }
    TwoCellFamily(const TwoCellFamily&) = delete;
    TwoCellFamily& operator=(const TwoCellFamily&) = delete;

    /// Whether the cell (column, row from the top) of tag `id` is white.
    bool is_white(int id, int column, int row) const {
        for (std::uint32_t bit = 0; bit < stock->nbits; ++bit) {
            if (static_cast<int>(bit_x[bit]) == column && static_cast<int>(bit_y[bit]) == row) {
                return (stock->codes[id] >> (stock->nbits - 1 - bit) & 1u) != 0;
            }
        }
        return false;
    }
};

struct FoundTag {
    int id = 0;
    std::array<Vector2d, 4> px;  // counter-clockwise from the tag's own lower left
};

using TagMap = std::map<int, std::array<Vector2d, 4>>;  // by place on the board

/// A family must leave the detector before either goes.
class Detector {
public:
    Detector(apriltag_family_t& family, int bits_corrected) : family_(family) {
        apriltag_detector_add_family_bits(detector_, &family_, bits_corrected);
        detector_->nthreads = 1;
        detector_->quad_decimate = 1;
        detector_->refine_edges = true;
    }
    ~Detector() {
        apriltag_detector_remove_family(detector_, &family_);
        apriltag_detector_destroy(detector_);
    }
    Detector(const Detector&) = delete;
    Detector& operator=(const Detector&) = delete;

    std::vector<FoundTag> detect(const cv::Mat& code) const {
        std::vector<FoundTag> tags;
        constexpr int smallest_side = 16;  // the library thresholds in tiles and expects a few of them
        if (std::min(code.cols, code.rows) < smallest_side) return tags;
        image_u8_t view = {code.cols, code.rows, static_cast<int>(code.step), code.data};
        zarray_t* found = apriltag_detector_detect(detector_, &view);
        for (int i = 0; i < zarray_size(found); ++i) {
            apriltag_detection_t* raw = nullptr;
            zarray_get(found, i, &raw);
            FoundTag tag{raw->id, {}};
            for (std::size_t c = 0; c < 4; ++c) tag.px[c] = pixel_from_detector({raw->p[c][0], raw->p[c][1]});
            tags.push_back(tag);
        }
        apriltag_detections_destroy(found);
        std::ranges::sort(tags, [](const FoundTag& a, const FoundTag& b) {
            return std::tuple(a.id, a.px[0].x(), a.px[0].y()) < std::tuple(b.id, b.px[0].x(), b.px[0].y());
        });
        return tags;
    }

private:
    apriltag_family_t& family_;
    apriltag_detector_t* detector_ = apriltag_detector_create();
};

class AprilgridDetector : public BoardDetector {
public:
    explicit AprilgridDetector(const BoardSpec& board)
        : board_(board), points_(board_corners_m(board)), detector_(family_.family, allowed_wrong_bits) {}

    BoardSighting detect(const BoardPicture& picture) const override {
        TagMap tags = find_tags(picture.code);
        drop_strays(tags);
        const int read = static_cast<int>(tags.size());
        // Fewer than two tags could stand in any of four ways.
        if (read < 2) return {{}, read, 0};
        const int turn = turn_of(tags);
        for (auto& [place, px] : tags) std::rotate(px.begin(), px.begin() + turn, px.end());
        grow(picture, turn, tags);

        BoardSighting sighting;
        sighting.marks = static_cast<int>(tags.size());
        const std::vector<BoardAnchor> anchors = anchors_of(tags);
        for (const auto& [place, px] : tags) {
            for (int c = 0; c < 4; ++c) {
                const int index = 4 * place + c;
                constexpr std::size_t two_tags = 8;
                std::optional<LocalView> view = local_view(anchors, board_place(index), two_tags);
                if (!view) continue;
                view->px = px[static_cast<std::size_t>(c)];
                measure_corner(picture, *view, plain_radius_m(board_), index, sighting.corners);
            }
        }
        finish_sighting(sighting);
        return sighting;
    }

    std::string seen_instead(const BoardPicture& picture) const override {
        apriltag_family_t* stock = tag36h11_create();
        std::size_t one_cell = 0;
        {
            const Detector detector(*stock, allowed_wrong_bits);
            one_cell = detector.detect(view_of(picture.code)).size();
        }
        tag36h11_destroy(stock);
        const std::vector<FoundTag> two_cells = detector_.detect(view_of(picture.code));
        if (!two_cells.empty()) {
            std::set<int> ids;
            for (const FoundTag& tag : two_cells) ids.insert(tag.id);
            return fmt::format("{} of its kind of tags, ids {} to {}", two_cells.size(), *ids.begin(), *ids.rbegin());
        }
        if (one_cell > 0) return fmt::format("{} tags with a border of one cell, which is not Kalibr's", one_cell);
        return {};
    }

private:
    /// Three wrong bits would take the library much memory; codes differ in eleven.
    static constexpr int allowed_wrong_bits = 2;

    static cv::Mat view_of(const Image8& code) {
        return {code.height(), code.width(), CV_8UC1, const_cast<std::uint8_t*>(code.samples().data())};
    }

    Vector2d board_place(int index) const { return points_[static_cast<std::size_t>(index)].head<2>(); }

    /// In the picture as it is, and with its white grown by a pixel: blur joins a tag to the squares at its corners,
    /// and then no quadrangle is left to be found. Tags of the grown picture are smaller by that pixel, which the
    /// measurement of the corners makes good.
    TagMap find_tags(const Image8& code) const {
        const cv::Mat picture = view_of(code);
        cv::Mat grown;
        cv::dilate(picture, grown, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
        TagMap tags;
        std::set<int> twice;
        for (const cv::Mat& each : {picture, grown}) {
            std::set<int> here;
            TagMap found;
            for (const FoundTag& tag : detector_.detect(each)) {
                const int place = tag.id - board_.first_id;
                if (place < 0 || place >= board_.columns * board_.rows) continue;
                if (!here.insert(place).second) twice.insert(place);
                found.emplace(place, tag.px);
            }
            tags.merge(found);
        }
        for (const int place : twice) tags.erase(place);  // which of the two is the board's, nobody knows
        return tags;
    }

    std::vector<BoardAnchor> anchors_of(const TagMap& tags) const {
        std::vector<BoardAnchor> anchors;
        for (const auto& [place, px] : tags) {
            for (int c = 0; c < 4; ++c)
                anchors.push_back({board_place(4 * place + c), px[static_cast<std::size_t>(c)]});
        }
        return anchors;
    }

    Vector2d middle_m(int place) const { return (board_place(4 * place) + board_place(4 * place + 2)) / 2; }

    /// Leaves out tags whose middle lies a tag's side or more from where the nearest others put it.
    void drop_strays(TagMap& tags) const {
        std::set<int> strays;
        std::vector<std::pair<int, BoardAnchor>> middles;
        for (const auto& [place, px] : tags) {
            middles.push_back({place, {middle_m(place), (px[0] + px[1] + px[2] + px[3]) / 4}});
        }
        if (middles.size() < 6) return;  // too few to tell which is the stray one
        for (const auto& [place, middle] : middles) {
            std::vector<BoardAnchor> others;
            for (const auto& [other, anchor] : middles) {
                if (other != place) others.push_back(anchor);
            }
            constexpr std::size_t all_but_far = 12;
            const std::optional<LocalView> view = local_view(others, middle.board_m, all_but_far);
            if (!view) continue;
            const double tag_px = std::sqrt(std::abs(view->px_from_board.determinant())) * board_.tag_m;
            if ((view->px - middle.px).norm() > tag_px) strays.insert(place);
        }
        if (2 * strays.size() >= middles.size()) return;
        for (const int place : strays) tags.erase(place);
    }

    /// By how many corners the tags' own lower left differs from the board's: whoever made the board chose.
    int turn_of(const TagMap& tags) const {
        int best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (int turn = 0; turn < 4; ++turn) {
            TagMap turned = tags;
            for (auto& [place, px] : turned) std::rotate(px.begin(), px.begin() + turn, px.end());
            const std::vector<BoardAnchor> anchors = anchors_of(turned);
            const std::optional<Eigen::Matrix3d> h = homography_of(anchors);
            if (!h) continue;
            double sum = 0;
            for (const BoardAnchor& a : anchors) sum += ((*h * a.board_m.homogeneous()).hnormalized() - a.px).norm();
            if (sum < least) {
                least = sum;
                best = turn;
            }
        }
        return best;
    }

    /// Adds tags that the detector missed: where their neighbours put them, if their cells read as they should.
    void grow(const BoardPicture& picture, int turn, TagMap& tags) const {
        for (bool added = true; added;) {
            added = false;
            const std::vector<BoardAnchor> anchors = anchors_of(tags);
            for (int place = 0; place < board_.columns * board_.rows; ++place) {
                if (tags.contains(place) || !has_neighbour(tags, place)) continue;
                std::array<Vector2d, 4> px;
                bool placed = true;
                for (int c = 0; c < 4 && placed; ++c) {
                    constexpr std::size_t two_tags = 8;
                    const auto view = local_view(anchors, board_place(4 * place + c), two_tags);
                    std::vector<BoardCorner> measured;
                    placed = view && measure_corner(picture, *view, plain_radius_m(board_), 0, measured);
                    if (placed) px[static_cast<std::size_t>(c)] = measured[0].px;
                }
                if (!placed || !reads(picture.code, place, turn, px)) continue;
                tags.emplace(place, px);
                added = true;
            }
        }
    }

    bool has_neighbour(const TagMap& tags, int place) const {
        const int row = place / board_.columns, column = place % board_.columns;
        return (column > 0 && tags.contains(place - 1)) || (column + 1 < board_.columns && tags.contains(place + 1)) ||
               (row > 0 && tags.contains(place - board_.columns)) ||
               (row + 1 < board_.rows && tags.contains(place + board_.columns));
    }

    /// Whether the cells between these corners spell the tag's code and its black border.
    bool reads(const Image8& code, int place, int turn, std::array<Vector2d, 4> px) const {
        std::rotate(px.begin(), px.end() - turn, px.end());  // back to the tag's own lower left
        const std::array<Vector2d, 4> cells = {{{0, tag_cells}, {tag_cells, tag_cells}, {tag_cells, 0}, {0, 0}}};
        std::vector<BoardAnchor> anchors;
        for (std::size_t c = 0; c < 4; ++c) anchors.push_back({cells[c], px[c]});
        const std::optional<Eigen::Matrix3d> h = homography_of(anchors);
        if (!h) return false;
        std::array<std::array<int, tag_cells>, tag_cells> values{};
        int darkest = 255, brightest = 0;
        for (int row = 0; row < tag_cells; ++row) {
            for (int column = 0; column < tag_cells; ++column) {
                const Vector2d at = (*h * Eigen::Vector3d(column + 0.5, row + 0.5, 1)).hnormalized();
                const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
                if (!code.bounds().contains(x, y)) return false;
                const int value = code.at(x, y);
                values[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = value;
                darkest = std::min(darkest, value);
                brightest = std::max(brightest, value);
            }
        }
        int wrong = 0;
        for (int row = 0; row < tag_cells; ++row) {
            for (int column = 0; column < tag_cells; ++column) {
                const bool white =
                    2 * values[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] > darkest + brightest;
                if (white != family_.is_white(board_.first_id + place, column, row)) ++wrong;
            }
        }
        constexpr int least_contrast = 20;  // code values: below it is noise
        // A tenth of the cells: by chance half of them would be wrong.
        return brightest - darkest >= least_contrast && wrong <= tag_cells * tag_cells / 10;
    }

    BoardSpec board_;
    std::vector<Eigen::Vector3d> points_;
    mutable TwoCellFamily family_;
    Detector detector_;
};

}  // namespace

std::unique_ptr<BoardDetector> create_aprilgrid_detector(const BoardSpec& board) {
    return std::make_unique<AprilgridDetector>(board);
}

}  // namespace matchlight
