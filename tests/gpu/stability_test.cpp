// The cases of `matchlight report --stability`, each as a test; and that their judge can say no.
#include <cmath>
#include <stdexcept>

#include "gl_fixture.h"
#include "report/stability_cases.h"

namespace matchlight {
namespace {

class StabilityTest : public GlTest, public testing::WithParamInterface<std::size_t> {};

const std::vector<StabilityCase>& cases() {
    static const std::vector<StabilityCase> all = stability_cases();
    return all;
}

TEST_P(StabilityTest, StaysWithinItsBound) {
    const StabilityCase& tried = cases().at(GetParam());
    const StabilityRow row = stability_row(tried);
    EXPECT_TRUE(row.pass) << row.effect << ", " << row.name << ": " << row.value << " (" << row.bound << ")"
                          << (row.energy_kept ? ", energy kept " + std::to_string(*row.energy_kept) : "");
}

INSTANTIATE_TEST_SUITE_P(Cases, StabilityTest, testing::Range<std::size_t>(0, cases().size()));

StabilityCase giving(double value, std::optional<double> energy = {}) {
    return {"x", "y", "value", {0, 1}, energy ? std::optional(Bound{0.9, 1.1}) : std::nullopt, [=] {
                return StabilityOutcome{value, energy};
            }};
}

TEST(StabilityRow, PassesWithinItsBoundsOnly) {
    EXPECT_TRUE(stability_row(giving(0)).pass);
    EXPECT_TRUE(stability_row(giving(1)).pass);
    EXPECT_FALSE(stability_row(giving(1.001)).pass);
    EXPECT_FALSE(stability_row(giving(-1e-9)).pass);
    EXPECT_FALSE(stability_row(giving(std::numeric_limits<double>::quiet_NaN())).pass);
    EXPECT_FALSE(stability_row(giving(std::numeric_limits<double>::infinity())).pass);
    EXPECT_TRUE(stability_row(giving(0.5, 1.0)).pass);
    EXPECT_FALSE(stability_row(giving(0.5, 0.5)).pass);
    StabilityCase without_energy = giving(0.5, 1.0);
    without_energy.run = [] { return StabilityOutcome{0.5, {}}; };
    EXPECT_FALSE(stability_row(without_energy).pass);
    StabilityCase thrown = giving(0);
    thrown.run = []() -> StabilityOutcome { throw std::runtime_error("no"); };
    EXPECT_FALSE(stability_row(thrown).pass);
}

}  // namespace
}  // namespace matchlight
