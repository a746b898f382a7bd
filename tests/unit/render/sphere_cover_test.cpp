// What spheres in front may hide: never told where a part of the picture is bare.
#include "render/sphere_cover.h"

#include <utility>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

constexpr int side_px = 640;  // ten pixels a tile

CellInPicture cell(double left, double top, double right, double bottom, double discs_px = 0) {
    return {Eigen::AlignedBox2d(Eigen::Vector2d(left, top), Eigen::Vector2d(right, bottom)), discs_px};
}

/// Deep enough for any cell of these pictures: the logarithms of their areas are below 14.
constexpr double deep = 14;

TEST(SphereCover, NothingHidesBeforeAnythingIsDrawn) {
    const SphereCover cover(side_px, side_px);
    EXPECT_FALSE(cover.may_hide(cell(100, 100, 200, 200)));
    EXPECT_FALSE(cover.may_hide(cell(0, 0, side_px, side_px)));
    EXPECT_FALSE(cover.may_hide(cell(5, 5, 5, 5))) << "a point";
}

TEST(SphereCover, HidesWhereDiscsLieManyDeepAndNowhereElse) {
    SphereCover cover(side_px, side_px);
    cover.add(cell(100, 100, 199, 199, deep * 100 * 100));
    EXPECT_TRUE(cover.may_hide(cell(100, 100, 199, 199)));
    EXPECT_TRUE(cover.may_hide(cell(145, 145, 155, 155)));
    EXPECT_FALSE(cover.may_hide(cell(300, 100, 399, 199)));
    // One bare tile is enough to be seen through.
    EXPECT_FALSE(cover.may_hide(cell(100, 100, 201, 199)));
    EXPECT_FALSE(cover.may_hide(cell(100, 98, 199, 199)));
}

TEST(SphereCover, OneLayerOfDiscsHidesNothing) {
    SphereCover cover(side_px, side_px);
    cover.add(cell(100, 100, 199, 199, 1.9 * 100 * 100));
    EXPECT_FALSE(cover.may_hide(cell(150, 150, 151, 151)));
    cover.add(cell(100, 100, 199, 199, 0.2 * 100 * 100));
    EXPECT_TRUE(cover.may_hide(cell(150, 150, 151, 151))) << "depths add up";
}

TEST(SphereCover, LargerCellsAskForMore) {
    SphereCover cover(side_px, side_px);
    // e⁻⁵ of what is below stays bare: of 4 pixels hardly one, of 10,000 many.
    cover.add(cell(100, 100, 199, 199, 5 * 100 * 100));
    EXPECT_TRUE(cover.may_hide(cell(150, 150, 152, 152)));
    EXPECT_FALSE(cover.may_hide(cell(100, 100, 199, 199)));
    cover.add(cell(100, 100, 199, 199, 5 * 100 * 100));
    EXPECT_TRUE(cover.may_hide(cell(100, 100, 199, 199)));
}

TEST(SphereCover, DiscsAreSharedAmongTheTilesThatTheirCellTouches) {
    SphereCover cover(side_px, side_px);
    // Deep for one tile, spread over four.
    cover.add(cell(105, 105, 115, 115, 4 * 1.9 * 100));
    EXPECT_FALSE(cover.may_hide(cell(106, 106, 107, 107)));
    cover.add(cell(105, 105, 115, 115, 4 * 0.2 * 100));
    EXPECT_TRUE(cover.may_hide(cell(106, 106, 107, 107)));
    EXPECT_TRUE(cover.may_hide(cell(111, 111, 112, 112)));
}

TEST(SphereCover, TheLastTilesReachThePicturesEnds) {
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(7, 3), std::pair(641, 1000)}) {
        SphereCover cover(width, height);
        const CellInPicture all = cell(0, 0, width, height, deep * width * height);
        EXPECT_FALSE(cover.may_hide(all)) << width;
        // A tile that is touched counts whole, so that a picture of fewer pixels than tiles takes no more.
        cover.add(all);
        EXPECT_TRUE(cover.may_hide(all)) << width;
        EXPECT_TRUE(cover.may_hide(cell(width, height, width, height))) << width;
    }
    EXPECT_FALSE(SphereCover(0, 0).may_hide(cell(0, 0, 1, 1)));
}

TEST(SphereCover, WhatIsNotInThePictureCoversNothing) {
    SphereCover cover(side_px, side_px);
    const CellInPicture nowhere{Eigen::AlignedBox2d(), 1e9};
    cover.add(nowhere);
    EXPECT_FALSE(cover.may_hide(cell(0, 0, side_px, side_px)));
    EXPECT_FALSE(cover.may_hide(cell(0, 0, 1, 1)));
    EXPECT_TRUE(cover.may_hide(nowhere)) << "none of its pixels is seen";
}

}  // namespace
}  // namespace matchlight
