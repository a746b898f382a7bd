// ChArUco boards: markers by OpenCV, the chessboard's corners between them measured in linear light.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <fmt/format.h>
#include <opencv2/aruco.hpp>

#include "calibration/aruco_dictionary.h"
#include "calibration/board_detector.h"
#include "calibration/corner_net.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;

struct Marker {
    int id = 0;
    std::array<Vector2d, 4> px;  // clockwise from the marker's own upper left
};

std::vector<Marker> find_markers(const Image8& code, int dictionary) {
    const cv::Mat view(code.height(), code.width(), CV_8UC1, const_cast<std::uint8_t*>(code.samples().data()));
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    const auto parameters = cv::aruco::DetectorParameters::create();
    cv::aruco::detectMarkers(view, cv::aruco::getPredefinedDictionary(dictionary), corners, ids, parameters);
    std::vector<Marker> markers;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        Marker marker{ids[i], {}};
        for (std::size_t c = 0; c < 4; ++c) marker.px[c] = {corners[i][c].x, corners[i][c].y};
        markers.push_back(marker);
    }
    std::ranges::sort(markers, [](const Marker& a, const Marker& b) {
        return std::pair(a.id, a.px[0].x()) < std::pair(b.id, b.px[0].x());
    });
    return markers;
}

class CharucoDetector : public BoardDetector {
public:
    explicit CharucoDetector(const BoardSpec& board)
        : board_(board), points_(board_corners_m(board)), dictionary_(aruco_dictionary_of(board).id) {
        place_markers(0);
        // With an odd number of rows both layouts are one; with an even number OpenCV has another since 4.6.1.
        if (board.rows % 2 == 0) place_markers(1);
    }

    BoardSighting detect(const BoardPicture& picture) const override {
        const std::vector<Marker> markers = find_markers(picture.code, dictionary_);
        BoardSighting best;
        for (const auto& layout : layouts_) {
            BoardSighting sighting = detect_layout(picture, markers, layout);
            if (sighting.corners.size() > best.corners.size()) best = std::move(sighting);
        }
        best.marks = static_cast<int>(markers.size());
        return best;
    }

    std::string seen_instead(const BoardPicture& picture) const override {
        std::string most_name;
        std::size_t most = 3;  // fewer are chance
        for (const ArucoDictionary& known : aruco_dictionaries()) {
            // Only the largest of each kind: it holds the others.
            const std::string_view name = known.name;
            if (name.ends_with("_50") || name.ends_with("_100") || name.ends_with("_250")) continue;
            const std::size_t count = find_markers(picture.code, known.id).size();
            if (count <= most) continue;
            most = count;
            most_name = name;
        }
        return most_name.empty() ? std::string() : fmt::format("{} markers of {}", most, most_name);
    }

private:
    using Layout = std::vector<std::array<Vector2d, 4>>;  // corners of each marker, clockwise from its upper left

    /// Rows count from the top of the printed board, y downward, as the corners' do. A marker stands in each white
    /// square; `parity` 0 has a black square at the upper left.
    void place_markers(int parity) {
        Layout layout;
        const double inset = (board_.square_m - board_.marker_m) / 2;
        for (int row = 0; row < board_.rows; ++row) {
            for (int column = 0; column < board_.columns; ++column) {
                if ((row + column) % 2 == parity) continue;
                const Vector2d at(column * board_.square_m + inset, row * board_.square_m + inset);
                const double m = board_.marker_m;
                layout.push_back({at, at + Vector2d(m, 0), at + Vector2d(m, m), at + Vector2d(0, m)});
            }
        }
        layouts_.push_back(std::move(layout));
    }

    BoardSighting detect_layout(const BoardPicture& picture, const std::vector<Marker>& markers,
                                const Layout& layout) const {
        std::vector<BoardAnchor> anchors;
        for (const Marker& marker : markers) {
            if (marker.id >= static_cast<int>(layout.size())) continue;
            const auto& places = layout[static_cast<std::size_t>(marker.id)];
            for (std::size_t c = 0; c < 4; ++c) anchors.push_back({places[c], marker.px[c]});
        }
        BoardSighting sighting;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const Vector2d at = points_[i].head<2>();
            // Only between markers that were read: the next markers' corners lie within a square and a half.
            const auto near = std::ranges::count_if(anchors, [&](const BoardAnchor& anchor) {
                return (anchor.board_m - at).cwiseAbs().maxCoeff() < board_.square_m;
            });
            if (near < 4) continue;
            constexpr std::size_t two_markers = 8;
            const std::optional<LocalView> view = local_view(anchors, at, two_markers);
            if (!view || !agrees(*view, anchors, at)) continue;
            measure_corner(picture, *view, plain_radius_m(board_), static_cast<int>(i), sighting.corners);
        }
        finish_sighting(sighting);
        return sighting;
    }

    /// Whether the nearest anchors lie where the local view puts them, to a quarter of a square: a marker that was
    /// misread or belongs to the other layout does not.
    bool agrees(const LocalView& view, const std::vector<BoardAnchor>& anchors, const Vector2d& at) const {
        const double square_px = std::sqrt(std::abs(view.px_from_board.determinant())) * board_.square_m;
        return std::ranges::all_of(anchors, [&](const BoardAnchor& anchor) {
            const Vector2d offset = anchor.board_m - at;
            if (offset.cwiseAbs().maxCoeff() > board_.square_m) return true;
            return (view.px + view.px_from_board * offset - anchor.px).norm() < 0.25 * square_px;
        });
    }

    BoardSpec board_;
    std::vector<Eigen::Vector3d> points_;
    int dictionary_;
    std::vector<Layout> layouts_;
};

}  // namespace

std::unique_ptr<BoardDetector> create_charuco_detector(const BoardSpec& board) {
    return std::make_unique<CharucoDetector>(board);
}

}  // namespace matchlight
