// Sphere files written by a test and read again.
#pragma once

#include <string>
#include <string_view>

#include <gmock/gmock.h>

#include "core/error.h"
#include "scene/sphere_file.h"
#include "temporary_folder.h"

namespace matchlight {

class SphereFile : public TemporaryFolder {
protected:
    void SetUp() override {
        TemporaryFolder::SetUp();
        warnings_.set_quiet(true);
    }
    SphereSet load(const std::string& name, std::string_view bytes, const SphereSettings& settings = {}) {
        return load_sphere_set(write(name, bytes), settings, warnings_);
    }
    /// The line that a bad file gets, without its folder.
    std::string error_of(const std::string& name, std::string_view bytes, const SphereSettings& settings = {}) {
        try {
            load(name, bytes, settings);
        } catch (const InputError& error) {
            std::string line = error.what();
            EXPECT_EQ(line.find('\n'), std::string::npos);
            const std::string prefix = folder_.string() + "/";
            if (line.starts_with(prefix)) line.erase(0, prefix.size());
            return line;
        }
        return "no error";
    }
    std::string warning() const {
        std::string all;
        for (const auto& entry : warnings_.entries()) all += entry.text + "\n";
        return all;
    }

    Warnings warnings_;
};

/// Settings that differ from the defaults as `change` makes them.
template <class Change>
SphereSettings with(const Change& change) {
    SphereSettings settings;
    change(settings);
    return settings;
}

inline testing::Matcher<Sphere> sphere_at(float x, float y, float z, float radius) {
    using testing::ElementsAre, testing::Field, testing::FloatEq;
    return testing::AllOf(Field("centre", &Sphere::centre_m, ElementsAre(FloatEq(x), FloatEq(y), FloatEq(z))),
                          Field("radius", &Sphere::radius_m, FloatEq(radius)));
}

}  // namespace matchlight
