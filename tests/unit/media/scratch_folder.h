// A test fixture with a folder of its own that goes away with the test.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "core/warnings.h"

namespace matchlight {

class ScratchFolder : public testing::Test {
protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        std::string name = std::string(info->test_suite_name()) + "_" + info->name() + "_" + std::to_string(getpid());
        for (char& c : name) c = c == '/' ? '_' : c;
        folder_ = std::filesystem::temp_directory_path() / ("matchlight_" + name);
        std::filesystem::create_directories(folder_);
        warnings_.set_quiet(true);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    static std::string bytes_of(const std::filesystem::path& path) {
        std::ifstream stream(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    }
    std::filesystem::path write_bytes(const std::string& name, const std::string& bytes) const {
        const std::filesystem::path path = folder_ / name;
        std::ofstream stream(path, std::ios::binary);
        stream << bytes;
        return path;
    }
    /// How often warnings whose text contains `part` were counted.
    std::int64_t warned(const std::string& part) const {
        std::int64_t sum = 0;
        for (const auto& entry : warnings_.entries()) {
            if (entry.text.find(part) != std::string::npos) sum += entry.count;
        }
        return sum;
    }
    /// The message of the InputError that `action` throws; empty when it throws none.
    template <class Action>
    static std::string error_of(const Action& action) {
        try {
            action();
        } catch (const InputError& error) {
            return error.what();
        }
        return {};
    }

    std::filesystem::path folder_;
    Warnings warnings_;
};

}  // namespace matchlight
