// The context that GPU tests share, and the check that none of them leaves a GL error behind.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "gl/context.h"

namespace matchlight {

class GlTest : public testing::Test {
protected:
    static void SetUpTestSuite() {
        if (!context_) context_ = create_offscreen_context();
        context_->make_current();
    }
    void TearDown() override { EXPECT_NO_THROW(check_no_gl_error("after the test")); }

    static GlContext& context() { return *context_; }

private:
    static inline std::unique_ptr<GlContext> context_;
};

}  // namespace matchlight
