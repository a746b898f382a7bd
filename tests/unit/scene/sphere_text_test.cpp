// XYZ and CSV: what they hold arrives, and what is wrong with them is said with its line.
#include <locale>

#include "sphere_test.h"

namespace matchlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string water = "3\nwater\nO 0 0 0.25\nH 0 0.75 -0.5\nH 0 -0.75 -0.5\n";

TEST_F(SphereFile, XyzHasRadiiAndColoursOfItsElements) {
    const SphereSet set = load("water.xyz", water);
    // Bondi's radii, Jmol's colours.
    EXPECT_THAT(set.spheres, ElementsAre(sphere_at(0, 0, 0.25F, 1.52F), sphere_at(0, 0.75F, -0.5F, 1.2F),
                                         sphere_at(0, -0.75F, -0.5F, 1.2F)));
    ASSERT_EQ(set.colors.size(), 3u);
    EXPECT_EQ(set.colors[0], (std::array<std::uint8_t, 4>{0xff, 0x0d, 0x0d, 255}));
    EXPECT_EQ(set.colors[1], (std::array<std::uint8_t, 4>{0xff, 0xff, 0xff, 255}));
    EXPECT_THAT(set.opacities, IsEmpty());
    EXPECT_EQ(set.name, "water");
    EXPECT_FLOAT_EQ(set.bounds_m.max().z(), 0.25F + 1.52F);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(SphereFile, SettingsComeBeforeWhatTheFileSays) {
    const SphereSet set = load("w.xyz", water, with([](SphereSettings& s) {
                                   s.radius = 0.5;
                                   s.radius_scale = 2;
                                   s.opacity = 0.25;
                                   s.up = SphereAxes::y;
                               }));
    EXPECT_THAT(set.spheres[0], sphere_at(0, -0.25F, 0, 1));
    EXPECT_THAT(set.spheres[1], sphere_at(0, 0.5F, 0.75F, 1));
    EXPECT_EQ(set.opacity, 0.25F);
    EXPECT_TRUE(set.blends());
}

TEST_F(SphereFile, ExtendedXyzNamesItsColumns) {
    const std::string text =
        "2\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=species:S:1:pos:R:3:velo:R:3:radius:R:1:tag:S:1\n"
        "Fe 1 2 3 0.5 0 0 0.25 a\nXy 4 5 6 1.5 0 0 0.75 b\n";
    const SphereSet set = load("a.extxyz", text, with([](SphereSettings& s) {
                                   s.color_column = "velo_0";
                                   s.color_map = 7;
                               }));
    EXPECT_THAT(set.spheres, ElementsAre(sphere_at(1, 2, 3, 0.25F), sphere_at(4, 5, 6, 0.75F)));
    EXPECT_EQ(set.colors[0], (std::array<std::uint8_t, 4>{0, 0, 0, 255}));  // map 7 is grey, its range the column's
    EXPECT_EQ(set.colors[1], (std::array<std::uint8_t, 4>{255, 255, 255, 255}));
    EXPECT_TRUE(warnings_.empty());  // what has a radius and a colour of its own needs no element
    EXPECT_THAT(error_of("a.xyz", text, with([](SphereSettings& s) { s.color_column = "vello_0"; })),
                HasSubstr("no column 'vello_0' for color_column; did you mean 'velo_0'?"));
}

TEST_F(SphereFile, OneFrameOfATrajectoryIsRead) {
    const std::string two = "1\nfirst\nO 1 0 0\n2\nsecond\nO 2 0 0\nO 3 0 0\n";
    EXPECT_THAT(load("t.xyz", two).spheres, ElementsAre(sphere_at(1, 0, 0, 1.52F)));
    EXPECT_THAT(load("t.xyz", two, with([](SphereSettings& s) { s.frame = 1; })).spheres,
                ElementsAre(sphere_at(2, 0, 0, 1.52F), sphere_at(3, 0, 0, 1.52F)));
    EXPECT_THAT(error_of("t.xyz", two, with([](SphereSettings& s) { s.frame = 2; })),
                HasSubstr("it ends before frame 2; write or copy it again"));
}

TEST_F(SphereFile, UnknownElementsAreCounted) {
    EXPECT_EQ(load("x.xyz", "3\n\nFe3+ 0 0 0\nQq 0 0 1\n26 0 0 2\n").size(), 3u);
    EXPECT_THAT(warning(), HasSubstr("x.xyz: 1 atoms of no known element"));
}

TEST_F(SphereFile, CsvMapsColumnsByName) {
    const std::string text =
        "id,x,y,z,radius,heat,fade\n1,0,0,0,1,10,0.5\n2,4,0,0,2,20,1\n# a remark\n\n3,8,0,0,3,40,0\n";
    const SphereSet set = load("a.csv", text, with([](SphereSettings& s) {
                                   s.color_column = "heat";
                                   s.color_map = 7;
                                   s.color_range = std::array{10.0, 20.0};
                                   s.opacity_column = "fade";
                               }));
    EXPECT_THAT(set.spheres, ElementsAre(sphere_at(0, 0, 0, 1), sphere_at(4, 0, 0, 2), sphere_at(8, 0, 0, 3)));
    EXPECT_EQ(set.colors[0][0], 0);
    EXPECT_EQ(set.colors[1][0], 255);
    EXPECT_EQ(set.colors[2][0], 255);  // beyond the range
    EXPECT_THAT(set.opacities, ElementsAre(0.5F, 1, 0));
    EXPECT_THAT(load("a.csv", text, with([](SphereSettings& s) { s.radius_column = "heat"; })).spheres[2],
                sphere_at(8, 0, 0, 40));
    EXPECT_THAT(error_of("a.csv", text, with([](SphereSettings& s) { s.radius_column = "radios"; })),
                HasSubstr("did you mean 'radius'?"));
}

TEST_F(SphereFile, SeparatorsLineEndsAndQuotes) {
    for (const char* text :
         {"x;y;z;radius\r\n1;2;3;4\r\n", "x\ty\tz\tradius\n1\t2\t3\t4", "# x y z radius\n 1 2  3 4\n",
          "\xef\xbb\xbf\"x\",\"y\",\"z\",\"radius\"\n\"1\",\"2\",\"3\",+4\n"}) {
        EXPECT_THAT(load("a.csv", text).spheres, ElementsAre(sphere_at(1, 2, 3, 4))) << text;
    }
}

TEST_F(SphereFile, ColoursOfAFileAreBytesOrFractions) {
    const std::string names = "x,y,z,radius,red,green,blue\n";
    const SphereSet bytes = load("a.csv", names + "0,0,0,1,255,1,0\n0,0,0,1,0,0,1\n");
    EXPECT_EQ(bytes.colors[0], (std::array<std::uint8_t, 4>{255, 1, 0, 255}));
    EXPECT_EQ(bytes.colors[1], (std::array<std::uint8_t, 4>{0, 0, 1, 255}));
    const SphereSet fractions = load("a.csv", names + "0,0,0,1,1,0.5,0\n");
    EXPECT_EQ(fractions.colors[0], (std::array<std::uint8_t, 4>{255, 128, 0, 255}));
}

TEST_F(SphereFile, WhatIsNotFiniteIsLeftOutAndCounted) {
    const SphereSet set = load("a.csv", "x,y,z,radius\nnan,0,0,1\n0,inf,0,1\n1,2,3,4\n0,0,1e300,1\n");
    EXPECT_THAT(set.spheres, ElementsAre(sphere_at(1, 2, 3, 4)));
    EXPECT_THAT(warning(), HasSubstr("a.csv: 3 spheres whose place is not finite"));
}

TEST_F(SphereFile, OddOpacitiesAndColoursAreRepaired) {
    const SphereSet set = load("a.csv", "x,y,z,radius,opacity,heat\n0,0,0,1,2,1\n0,0,0,1,nan,2\n0,0,0,1,-1,nan\n",
                               with([](SphereSettings& s) {
                                   s.color_column = "heat";
                                   s.opacity = 0.5;
                               }));
    EXPECT_THAT(set.opacities, ElementsAre(0.5F, 0.5F, 0));
    EXPECT_EQ(set.colors[2], (std::array<std::uint8_t, 4>{128, 128, 128, 255}));
    EXPECT_THAT(warning(), HasSubstr("3 opacities outside 0 to 1"));
    EXPECT_THAT(warning(), HasSubstr("1 colours"));
}

TEST_F(SphereFile, RadiiThatAreNotAboveZeroNameTheLine) {
    for (const std::string radius : {"0", "-1", "nan", "inf", "1e-60"}) {
        EXPECT_THAT(error_of("a.csv", "x,y,z,radius\n0,0,0,1\n0,0,0," + radius + "\n"),
                    HasSubstr("a.csv:3: a sphere of radius"))
            << radius;
    }
    EXPECT_THAT(error_of("a.csv", "x,y,z\n0,0,0\n"), HasSubstr("how large its spheres are; give radius"));
}

TEST_F(SphereFile, FilesThatAreWrongNameTheLine) {
    EXPECT_THAT(error_of("a.csv", "x,y,z,radius\n0,0,0,1\n0,0,1\n"), HasSubstr("a.csv:3: it has 3 of 4 columns"));
    EXPECT_THAT(error_of("a.csv", "x,y,z,radius\n0,0,one,1\n"), HasSubstr("a.csv:2: 'one' is no number"));
    EXPECT_THAT(error_of("a.csv", "0,0,0,1\n"), HasSubstr("does not name the columns x, y and z"));
    EXPECT_THAT(error_of("a.csv", ""), HasSubstr("is empty"));
    EXPECT_THAT(error_of("a.csv", "x,y,z,radius\n" + std::string(3u << 20, '1')), HasSubstr("longer than"));
    EXPECT_THAT(error_of("a.xyz", "two\n\nO 0 0 0\n"),
                HasSubstr("a.xyz:1: 'two' is no number of atoms; write how many follow"));
    EXPECT_THAT(error_of("a.xyz", "-2\n\nO 0 0 0\n"), HasSubstr("no number of atoms"));
    EXPECT_THAT(error_of("a.xyz", "1000000000\n\nO 0 0 0\n"), HasSubstr("a.xyz:1: it promises 1000000000 atoms"));
    EXPECT_THAT(error_of("a.xyz", "2\n\nO 0.0000 0.0000 0.0000\n"), HasSubstr("ends before atom 2 of 2"));
    EXPECT_THAT(error_of("a.xyz", "1\n\nO 0 0\n"), HasSubstr("a.xyz:3: it has 3 of 4 columns"));
    EXPECT_THAT(error_of("a.xyz", "1\nProperties=species:S:1:pos:R\nO 0 0 0\n"), HasSubstr("name:type:columns"));
    EXPECT_THAT(error_of("a.xyz", "1\nProperties=species:S:1\nO 0 0 0\n"), HasSubstr("names no pos"));
    EXPECT_THAT(error_of("a.abc", "1\n"), HasSubstr("kind '.abc' are not supported"));
}

TEST_F(SphereFile, ALineOfAMillionCharactersIsNoHarm) {
    EXPECT_EQ(load("a.xyz", "1\n" + std::string(1'000'000, 'c') + "\nO 0 0 0\n").size(), 1u);
}

TEST_F(SphereFile, NoSpheresAreASetWithAWarning) {
    EXPECT_EQ(load("a.xyz", "0\n\n").size(), 0u);
    EXPECT_THAT(warning(), HasSubstr("a.xyz: it holds no spheres"));
    EXPECT_TRUE(load("b.csv", "x,y,z,radius\n").bounds_m.isEmpty());
}

TEST_F(SphereFile, DecimalCommasOfALocaleChangeNothing) {
    const std::locale before;
    try {
        std::locale::global(std::locale("de_DE.UTF-8"));
    } catch (const std::runtime_error&) {
        GTEST_SKIP() << "this machine has no German locale";
    }
    const SphereSet set = load("a.csv", "x,y,z,radius\n0.5,0,0,1.5\n");
    std::locale::global(before);
    EXPECT_THAT(set.spheres, ElementsAre(sphere_at(0.5F, 0, 0, 1.5F)));
}

}  // namespace
}  // namespace matchlight
