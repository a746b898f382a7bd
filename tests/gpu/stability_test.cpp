// The cases of `matchlight report --stability`, each as a test; and that their judge can say no.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "gl_fixture.h"
#include "report/stability_cases.h"

namespace matchlight {
namespace {

/// One test a part of the program: its cases share a context and the programs compiled in it.
class StabilityTest : public GlTest, public testing::WithParamInterface<std::string> {};

const std::vector<StabilityCase>& cases() {
    static const std::vector<StabilityCase> all = stability_cases();
    return all;
}

std::vector<std::string> parts() {
    std::vector<std::string> names;
    for (const StabilityCase& tried : cases()) {
        if (std::ranges::find(names, tried.effect) == names.end()) names.push_back(tried.effect);
    }
    return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& part) {
    std::string name = part.param;
    std::erase_if(name, [](unsigned char letter) { return letter == ','; });
    std::ranges::replace_if(
        name, [](unsigned char letter) { return std::isalnum(letter) == 0; }, '_');
    return name;
}

TEST_P(StabilityTest, StaysWithinItsBounds) {
    int tried_cases = 0;
    for (const StabilityCase& tried : cases()) {
        if (tried.effect != GetParam()) continue;
        const StabilityRow row = stability_row(tried);
        EXPECT_TRUE(row.pass) << row.effect << ", " << row.name << ": " << row.value << " (" << row.bound << ")"
                              << (row.energy_kept ? ", energy kept " + std::to_string(*row.energy_kept) : "");
        ++tried_cases;
    }
    EXPECT_GT(tried_cases, 0);
}

INSTANTIATE_TEST_SUITE_P(Parts, StabilityTest, testing::ValuesIn(parts()), test_name);

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
