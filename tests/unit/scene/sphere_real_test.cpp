// Sphere files that other programs wrote, where the data are at hand.
#include <cstdlib>

#include "sphere_test.h"

namespace matchlight {
namespace {

class RealSpheres : public SphereFile {
protected:
    void SetUp() override {
        SphereFile::SetUp();
        const char* data = std::getenv("MATCHLIGHT_DATA");
        if (data == nullptr) GTEST_SKIP() << "MATCHLIGHT_DATA names no folder of test data";
        data_ = std::filesystem::path(data) / "real" / "spheres";
    }
    SphereSet load_real(const char* name, const SphereSettings& settings = {}) {
        return load_sphere_set(data_ / name, settings, warnings_);
    }
    std::filesystem::path data_;
};

TEST_F(RealSpheres, HaveAsManyAsTheirFilesSay) {
    EXPECT_EQ(load_real("ngl_3l5q.gro").size(), 79452u);
    EXPECT_EQ(load_real("ngl_1M4X.pdb").size(), 9693u);  // records ATOM and HETATM
    EXPECT_EQ(load_real("ngl_3J6R.pdb").size(), 17214u);
    EXPECT_EQ(load_real("water.xyz").size(), 297u);  // of the first frame
    const auto radius = with([](SphereSettings& s) { s.radius = 0.01; });
    EXPECT_EQ(load_real("sph_bunny_frame_14_7705_particles.vtk", radius).size(), 7706u);
    EXPECT_EQ(load_real("sph_octocat_32614_particles.bgeo", radius).size(), 32614u);
    EXPECT_TRUE(warnings_.empty()) << warning();
}

TEST_F(RealSpheres, StandWhereTheirFilesSay) {
    EXPECT_THAT(load_real("ngl_3l5q.gro").spheres.front(), sphere_at(6.621F, -1.029F, -21.234F, 0.155F));  // nitrogen
    EXPECT_THAT(load_real("ngl_3l5q.gro").spheres.back(), sphere_at(-7.162F, -0.514F, -19.529F, 0.17F));   // carbon
    EXPECT_THAT(load_real("water.xyz").spheres.front(), sphere_at(0.417219F, 8.303366F, 11.737172F, 1.52F));
    const auto by_speed = with([](SphereSettings& s) {
        s.radius = 0.01;
        s.color_column = "velocity_1";
    });
    EXPECT_EQ(load_real("sph_bunny_frame_14_7705_particles.vtk", by_speed).colors.size(), 7706u);
}

}  // namespace
}  // namespace matchlight
