// What all post-process methods of depth of field hold to, and each against its double-precision reference.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "defocus_frame.h"
#include "gl_fixture.h"
#include "render/effects/defocus_diffusion.h"
#include "render/effects/defocus_layers.h"
#include "render/effects/defocus_mipmap.h"
#include "render/effects/defocus_one_pass.h"
#include "render/effects/defocus_two_pass.h"
#include "report/defocus_trial.h"

namespace matchlight::test {
namespace {

struct Method {
    const char* name;
    std::function<GraphTexture(RenderGraph&, ShaderLibrary&, const DefocusInput&, QualityLevel)> add;
};

const std::vector<Method> methods{
    {"two_pass",
     [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input, QualityLevel quality) {
         return add_two_pass_defocus(graph, shaders, input, two_pass_knobs(quality));
     }},
    {"one_pass",
     [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input, QualityLevel quality) {
         return add_one_pass_defocus(graph, shaders, input, one_pass_knobs(quality));
     }},
    {"diffusion",
     [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input, QualityLevel quality) {
         return add_diffusion_defocus(graph, shaders, input, diffusion_knobs(quality));
     }},
    {"layers", [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                  QualityLevel quality) { return add_layers_defocus(graph, shaders, input, layers_knobs(quality)); }},
    {"mipmap", [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                  QualityLevel quality) { return add_mipmap_defocus(graph, shaders, input, mipmap_knobs(quality)); }},
};

const Method& method(std::string_view name) {
    return *std::find_if(methods.begin(), methods.end(), [&](const Method& method) { return method.name == name; });
}

class DefocusMethodsTest : public GlTest {
protected:
    ImageF run(const Method& method, const DefocusImages& images, QualityLevel quality = QualityLevel::final_,
               Region region = {}) {
        return run_defocus(
            shaders_, images,
            [&](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input) {
                return method.add(graph, shaders, input, quality);
            },
            region);
    }

    ShaderLibrary shaders_;
};

TEST_F(DefocusMethodsTest, WhatIsInFocusKeepsItsBits) {
    DefocusImages images = slope_and_square(90, 70, 0.24);
    ImageF expected(90, 70, 4);
    std::copy(images.light.samples().begin(), images.light.samples().end(), expected.samples().begin());
    for (const Method& method : methods) {
        const ImageF result = run(method, images);
        EXPECT_TRUE(std::equal(result.samples().begin(), result.samples().end(), expected.samples().begin()))
            << method.name;
    }
}

TEST_F(DefocusMethodsTest, NothingStaysNothing) {
    for (const Method& method : methods) {
        const ImageF result = run(method, DefocusImages(40, 30));
        for (const float value : result.samples()) EXPECT_EQ(value, 0) << method.name;
    }
}

TEST_F(DefocusMethodsTest, WhatIsInFocusNeitherLeaksNorTakesFromBehind) {
    DefocusImages images(130, 110);
    for (int y = 0; y < 110; ++y) {
        for (int x = 0; x < 130; ++x) {
            const bool near = x >= 50 && x < 80 && y >= 40 && y < 70;
            images.set(x, y, near ? 1e4 + x : 0.25, near ? 0 : 17);
        }
    }
    for (const Method& method : methods) {
        const ImageF result = run(method, images);
        for (int y = 0; y < 110; ++y) {
            for (int x = 0; x < 130; ++x) {
                if (images.coc_px.at(x, y) == 0) {
                    ASSERT_EQ(result.at(x, y), images.light.at(x, y)) << method.name;
                } else {
                    ASSERT_LE(result.at(x, y), 0.25F * (1 + 1e-5F)) << method.name;
                }
            }
        }
    }
}

TEST_F(DefocusMethodsTest, AFlatSurfaceStaysFlatWhereItIsWhole) {
    for (const Method& method : methods) {
        DefocusImages images(120, 100);
        // Slices of different circles leave a seam between them, which is measured below.
        const double right_px = std::string_view(method.name) == "layers" ? -13 : 9;
        for (int y = 0; y < 100; ++y) {
            for (int x = 0; x < 120; ++x) images.set(x, y, 0.7, x < 60 ? -13 : right_px);
        }
        const ImageF result = run(method, images);
        for (int y = 0; y < 100; ++y) {
            for (int x = 0; x < 120; ++x) {
                ASSERT_NEAR(result.at(x, y), 0.7, 1e-5) << method.name;
                ASSERT_NEAR(result.at(x, y, 3), 1, 1e-5) << method.name;
            }
        }
    }
}

TEST_F(DefocusMethodsTest, AHighlightKeepsItsEnergy) {
    for (const double coc_px : {3.0, 12.4, -31.0}) {
        DefocusImages images(120, 116);
        images.set(61, 58, 1e5, coc_px);
        for (const Method& method : methods) {
            const ImageF result = run(method, images, QualityLevel::reference);
            EXPECT_NEAR(sum_of(result, 0) / 1e5, 1, 1e-4) << method.name << ", circle " << coc_px;
            EXPECT_NEAR(sum_of(result, 3), 1, 1e-4) << method.name << ", circle " << coc_px;
        }
    }
}

TEST_F(DefocusMethodsTest, ExtremesStayFiniteAndWithinWhatCameIn) {
    for (const double coc_px : {0.0, 1.0, 700.0, -700.0, -1e6}) {
        DefocusImages images(96, 80);
        for (int y = 20; y < 60; ++y) {
            for (int x = 30; x < 70; ++x) images.set(x, y, 0.3, coc_px);
        }
        images.set(48, 40, 1e5, coc_px);
        for (const Method& method : methods) {
            const ImageF result = run(method, images);
            for (int y = 0; y < 80; ++y) {
                for (int x = 0; x < 96; ++x) {
                    ASSERT_TRUE(result.at(x, y, 0) >= 0 && result.at(x, y, 0) <= 1.001e5F) << method.name << coc_px;
                    ASSERT_TRUE(result.at(x, y, 3) >= 0 && result.at(x, y, 3) <= 1 + 1e-5F) << method.name << coc_px;
                }
            }
        }
    }
}

TEST_F(DefocusMethodsTest, AShareOfTheFrameIsEnough) {
    DefocusImages images(160, 120);
    for (int y = 50; y < 70; ++y) {
        for (int x = 60; x < 90; ++x) images.set(x, y, (x + y) % 3, 10);
    }
    for (const Method& method : methods) {
        const ImageF whole = run(method, images), part = run(method, images, QualityLevel::final_, {40, 30, 80, 60});
        for (int y = 44; y < 76; ++y) {
            for (int x = 54; x < 96; ++x) {
                ASSERT_NEAR(part.at(x, y), whole.at(x, y), 1e-5) << method.name << " " << x << ", " << y;
            }
        }
    }
}

TEST_F(DefocusMethodsTest, TwoPassAgreesWithItsReference) {
    for (const double widest_px : {6.0, 24.0}) {
        const DefocusImages images = slope_and_square(120, 80, widest_px);
        const ImageD expected = reference_two_pass(images, 64);
        EXPECT_LT(worst_difference(run(method("two_pass"), images), expected), 2e-4) << widest_px;
    }
}

ImageF in_floats(const ImageD& image) {
    ImageF result(image.width(), image.height(), image.channels());
    std::copy(image.samples().begin(), image.samples().end(), result.samples().begin());
    return result;
}

TEST_F(DefocusMethodsTest, APointIsADiscToSomeAndNotToOthers) {
    constexpr double coc_px = 32;
    DefocusImages images(121, 121);
    images.set(60, 60, 1, coc_px);
    const auto beside_disc = [&](const char* name, QualityLevel quality) {
        return share_beside_disc(run(method(name), images, quality), 60, 60, coc_px);
    };
    // Two passes make a square around the disc, whose corners hold 1 − π/4.
    EXPECT_NEAR(beside_disc("two_pass", QualityLevel::final_), 1 - std::numbers::pi / 4, 0.01);
    EXPECT_NEAR(share_beside_disc(in_floats(reference_two_pass(images, 64)), 60, 60, coc_px), 1 - std::numbers::pi / 4,
                0.01);
    // A gather over every pixel has but the rim's softness to answer for; rings have gaps.
    const std::vector<DefocusTap> all = disc_taps(coc_px / 2);
    EXPECT_LT(share_beside_disc(in_floats(reference_one_pass(images, all, 64)), 60, 60, coc_px), 0.02);
    EXPECT_LT(beside_disc("one_pass", QualityLevel::reference), 0.1);
    EXPECT_GT(beside_disc("one_pass", QualityLevel::final_), 0.3);
    // A slice has the circle of its middle: half a slice's width of 32/32 and 32/12 px is at stake along the rim.
    EXPECT_LT(beside_disc("layers", QualityLevel::reference), 2 * 0.5 / coc_px);
    EXPECT_LT(beside_disc("layers", QualityLevel::final_), 2 * 1.34 / coc_px + 0.01);
    for (const char* name : {"mipmap", "diffusion"}) EXPECT_GT(beside_disc(name, QualityLevel::final_), 0.2) << name;
}

TEST_F(DefocusMethodsTest, TwoPassHardlySpreadsOverWhatIsInFocus) {
    DefocusImages images(61, 61);
    for (int y = 0; y < 61; ++y) {
        for (int x = 0; x < 61; ++x) images.set(x, y, 0, 0);
    }
    images.set(30, 30, 1, -16);
    const ImageF result = run(method("two_pass"), images);
    EXPECT_LT(worst_difference(result, reference_two_pass(images, 64)), 1e-5);
    // Nothing else reaches the point's own pixel, so that it stays; beside it, a pixel in focus outweighs it by
    // (8/½)² in each pass. The lens would leave 1/64 at most anywhere.
    EXPECT_GT(result.at(30, 30), 0.9);
    EXPECT_NEAR(result.at(33, 30), 1.0 / 257, 1e-4);
    EXPECT_LT(result.at(33, 33), 1e-4);
}

TEST_F(DefocusMethodsTest, OnePassAgreesWithItsReference) {
    for (const double widest_px : {6.0, 24.0}) {
        const DefocusImages images = slope_and_square(120, 80, widest_px);
        const OnePassKnobs knobs = one_pass_knobs(QualityLevel::final_);
        const ImageD expected = reference_one_pass(images, ring_taps(widest_px / 2, knobs), knobs.largest_radius_px);
        EXPECT_LT(worst_difference(run(method("one_pass"), images), expected), 2e-4) << widest_px;
    }
}

TEST_F(DefocusMethodsTest, DiffusionAgreesWithItsReference) {
    for (const double widest_px : {6.0, 24.0, 300.0}) {
        for (const QualityLevel quality : {QualityLevel::final_, QualityLevel::reference}) {
            const DefocusImages images = slope_and_square(120, 80, widest_px);
            const ImageD expected = reference_diffusion(images, diffusion_knobs(quality).steps);
            EXPECT_LT(worst_difference(run(method("diffusion"), images, quality), expected), 1e-4) << widest_px;
        }
    }
}

TEST_F(DefocusMethodsTest, DiffusionKeepsItsEnergyAtAnyConductivity) {
    for (const double conductivity : {1.0, 1e3, 1e6, 1e8, 1e10, 1e12}) {
        const double coc_px = -std::sqrt(32 * conductivity);
        DefocusImages images(500, 37);
        for (int y = 0; y < 37; ++y) {
            for (int x = 0; x < 500; ++x) {
                if ((x + 3 * y) % 7 < 5) images.set(x, y, 1 + (x * 13 + y * 7) % 11, coc_px);
            }
        }
        images.set(400, 11, 1e5, coc_px);
        const ImageF result = run(method("diffusion"), images);
        EXPECT_NEAR(sum_of(result, 0) / sum_of(images.light, 0), 1, 1e-5) << conductivity;
        EXPECT_NEAR(sum_of(result, 3) / sum_of(images.light, 3), 1, 1e-5) << conductivity;
        for (const float value : result.samples()) ASSERT_TRUE(std::isfinite(value) && value >= 0) << conductivity;
        EXPECT_LT(result.at(400, 11), 5e4) << "it spread";
    }
}

TEST_F(DefocusMethodsTest, DiffusionHasTheVarianceOfADisc) {
    for (const double coc_px : {4.0, 16.0}) {
        DefocusImages images(241, 241);
        images.set(120, 120, 1, coc_px);
        for (const QualityLevel quality : {QualityLevel::final_, QualityLevel::reference}) {
            const ImageF result = run(method("diffusion"), images, quality);
            double across = 0, down = 0;
            for (int y = 0; y < 241; ++y) {
                for (int x = 0; x < 241; ++x) {
                    across += result.at(x, y) * (x - 120) * (x - 120);
                    down += result.at(x, y) * (y - 120) * (y - 120);
                }
            }
            EXPECT_NEAR(across / (coc_px * coc_px / 16), 1, 1e-3);
            EXPECT_NEAR(down / (coc_px * coc_px / 16), 1, 1e-3);
        }
    }
}

TEST_F(DefocusMethodsTest, LayersAgreeWithTheirReference) {
    for (const double widest_px : {6.0, 24.0}) {
        const DefocusImages images = slope_and_square(120, 80, widest_px);
        for (const bool disjoint : {false, true}) {
            const LayersKnobs knobs{.slices = 9, .radius_texels = 64, .disjoint = disjoint};
            const ImageF result =
                run_defocus(shaders_, images, [&](RenderGraph& graph, ShaderLibrary& s, const DefocusInput& input) {
                    return add_layers_defocus(graph, s, input, knobs);
                });
            const ImageD expected = reference_layers(
                images, {.slices = defocus_slices(-widest_px, widest_px, 9), .bokeh = {}, .disjoint = disjoint});
            EXPECT_LT(worst_difference(result, expected), 1e-4) << widest_px;
        }
    }
}

TEST_F(DefocusMethodsTest, SlicesLeaveSeamsWhereASurfaceRunsThroughThem) {
    // All of the frame is covered; what is left of that is the seams' doing.
    DefocusImages images(240, 40);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 240; ++x) images.set(x, y, 0.5, 4 + std::round(64 * x / 15.0) / 64);
    }
    const auto least_coverage = [&](int slices, bool disjoint) {
        const ImageF result =
            run_defocus(shaders_, images, [&](RenderGraph& graph, ShaderLibrary& s, const DefocusInput& input) {
                return add_layers_defocus(graph, s, input, {.slices = slices, .disjoint = disjoint});
            });
        float least = 1;
        for (int x = 0; x < 240; ++x) least = std::min(least, result.at(x, 20, 3));
        return least;
    };
    // Slices that add up come together as they get finer; over, each takes its share of what the others left, and finer
    // ones do not help: of two straight edges 1 − 1/4 is left, of many narrow ones 1 − 1/e, and less where circles
    // differ.
    double last = 0;
    for (const int slices : {2, 8, 64}) {
        const double added = least_coverage(slices, true), over = least_coverage(slices, false);
        EXPECT_GT(added, last);
        EXPECT_LT(over, 0.75);
        EXPECT_GT(over, 0.6);
        EXPECT_GT(added, over);
        last = added;
    }
    EXPECT_GT(last, 0.97);
}

TEST_F(DefocusMethodsTest, MipmapAgreesWithItsReference) {
    for (const auto& [widest_px, levels] : {std::pair{2.0, 1}, {6.0, 2}, {24.0, 4}, {300.0, 7}}) {
        const DefocusImages images = slope_and_square(121, 83, widest_px);
        EXPECT_LT(worst_difference(run(method("mipmap"), images), reference_mipmap(images, levels)), 2e-4) << widest_px;
    }
}

TEST_F(DefocusMethodsTest, MipmapHasTheVarianceOfADisc) {
    for (const double coc_px : {1.5, 4.0, 9.0, 20.0}) {
        DefocusImages images(160, 160);
        images.set(77, 81, 1, coc_px);
        const ImageF result = run(method("mipmap"), images);
        double across = 0, mean = 0;
        for (int y = 0; y < 160; ++y) {
            for (int x = 0; x < 160; ++x) {
                across += result.at(x, y) * (x - 77) * (x - 77);
                mean += result.at(x, y) * (x - 77);
            }
        }
        // Where the point lies in its texels moves the mean, by less than a quarter of the finer one.
        EXPECT_NEAR((across - mean * mean) / (coc_px * coc_px / 16), 1, 0.15) << coc_px;
        EXPECT_LT(std::abs(mean), 0.25 * coc_px) << coc_px;
    }
}

}  // namespace
}  // namespace matchlight::test
