// Every shader of the repository compiles and links; errors name file and line, through includes too; what is saved is
// compiled again.
#include "gl/shader_library.h"

#include <cstdlib>
#include <fstream>
#include <optional>
#include <regex>

#include <gmock/gmock.h>

#include "core/error.h"
#include "gl_fixture.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

class Shaders : public GlTest {};

std::string error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// A folder of shaders that vanishes with the test.
class ShaderFolder {
public:
    ShaderFolder() {
        std::string pattern = (fs::temp_directory_path() / "matchlight-shaders-XXXXXX").string();
        root_ = mkdtemp(pattern.data());
    }
    ShaderFolder(const ShaderFolder&) = delete;
    ShaderFolder& operator=(const ShaderFolder&) = delete;
    ~ShaderFolder() { fs::remove_all(root_); }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((root_ / name).parent_path());
        std::ofstream(root_ / name) << text;
    }
    const fs::path& root() const { return root_; }

private:
    fs::path root_;
};

// The rule that lets a test compile everything: each stage compiles without definitions (a file gives its own
// defaults under #ifndef), and x.frag links with the vertex shader it names in a comment ("Links with a/b.vert"), or
// with the x.vert beside it, or else with common/fullscreen.vert.
std::string partner_of(const fs::path& root, const fs::path& fragment_file) {
    std::ifstream stream(root / fragment_file);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    std::smatch named;
    if (std::regex_search(text, named, std::regex(R"(Links with ([\w/]+\.vert))"))) return named[1];
    const fs::path beside = fs::path(fragment_file).replace_extension(".vert");
    return fs::exists(root / beside) ? beside.string() : "common/fullscreen.vert";
}

TEST_F(Shaders, all_of_the_repository_compile_and_link) {
    const fs::path root = fs::path(MATCHLIGHT_SOURCE_DIR) / "shaders";
    ShaderLibrary library(root);
    int fragments = 0;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
        const fs::path file = entry.path().lexically_relative(root);
        const std::string extension = file.extension().string();
        SCOPED_TRACE(file.string());
        if (extension == ".vert") {
            EXPECT_NO_THROW(compile_shader(root, {GL_VERTEX_SHADER, file.string()}, {}));
        } else if (extension == ".comp") {
            EXPECT_NO_THROW(library.compute(file.string()));
        } else if (extension == ".frag") {
            ++fragments;
            EXPECT_NO_THROW(
                library.program({{GL_VERTEX_SHADER, partner_of(root, file)}, {GL_FRAGMENT_SHADER, file.string()}}));
        } else if (entry.is_regular_file()) {
            EXPECT_EQ(extension, ".glsl") << "neither a stage nor an include";
        }
    }
    EXPECT_TRUE(fs::exists(root / "common/fullscreen.vert"));
    RecordProperty("fragment_shaders", fragments);
}

TEST_F(Shaders, a_compile_error_names_file_and_line) {
    const ShaderFolder folder;
    folder.write("broken.frag",
                 "#version 450 core\n"
                 "out vec4 color;\n"
                 "void main() {\n"
                 "    color = vec4(undeclared_thing);\n"
                 "}\n");
    const std::string error = error_of([&] {
        compile_shader(folder.root(), {GL_FRAGMENT_SHADER, "broken.frag"}, {{"SIZE", "3"}});
    });
    EXPECT_THAT(error, testing::HasSubstr("broken.frag:4"));
    EXPECT_THAT(error, testing::HasSubstr("undeclared_thing"));
    EXPECT_THAT(error, testing::Not(testing::HasSubstr("\n")));
}

TEST_F(Shaders, an_error_in_an_include_names_the_include_and_its_line) {
    const ShaderFolder folder;
    folder.write("common/fine.glsl", "float fine() { return 1.0; }\n");
    folder.write("common/inner.glsl", "#include \"common/fine.glsl\"\n\nfloat inner() { return wrong_name; }\n");
    folder.write("outer.frag",
                 "#version 450 core\n"
                 "#include \"common/inner.glsl\"\n"
                 "#include \"common/fine.glsl\"\n"
                 "out vec4 color;\n"
                 "void main() { color = vec4(inner() + fine()); }\n");
    const auto compile = [&] { compile_shader(folder.root(), {GL_FRAGMENT_SHADER, "outer.frag"}, {}); };
    EXPECT_THAT(error_of(compile), testing::HasSubstr("common/inner.glsl:3"));
    EXPECT_THAT(error_of(compile), testing::Not(testing::HasSubstr("outer.frag:3")));
    // And after the includes the lines of the outer file count on.
    folder.write("common/inner.glsl", "#include \"common/fine.glsl\"\n\nfloat inner() { return fine(); }\n");
    folder.write("outer.frag",
                 "#version 450 core\n"
                 "#include \"common/inner.glsl\"\n"
                 "#include \"common/fine.glsl\"\n"
                 "out vec4 color;\n"
                 "void main() { color = vec4(inner() + other_wrong_name); }\n");
    EXPECT_THAT(error_of(compile), testing::HasSubstr("outer.frag:5"));
}

TEST_F(Shaders, missing_and_outside_files_are_errors) {
    const ShaderFolder folder;
    folder.write("a.frag", "#version 450 core\n#include \"common/none.glsl\"\nvoid main() {}\n");
    folder.write("b.frag", "#version 450 core\n#include \"../secret.glsl\"\nvoid main() {}\n");
    folder.write("c.frag", "void main() {}\n");
    const auto compile = [&](const std::string& name) {
        return error_of([&] { compile_shader(folder.root(), {GL_FRAGMENT_SHADER, name}, {}); });
    };
    EXPECT_THAT(compile("a.frag"),
                testing::AllOf(testing::HasSubstr("common/none.glsl"), testing::HasSubstr("a.frag:2")));
    EXPECT_THAT(compile("b.frag"), testing::HasSubstr("outside the shader folder"));
    EXPECT_THAT(compile("c.frag"), testing::HasSubstr("#version"));
    EXPECT_THAT(compile("d.frag"), testing::HasSubstr("cannot be read"));
}

TEST_F(Shaders, definitions_reach_the_shader_and_variants_are_kept_apart) {
    const ShaderFolder folder;
    folder.write("value.comp",
                 "#version 450 core\n"
                 "layout(local_size_x = 1) in;\n"
                 "layout(std430, binding = 0) buffer Result { float result; };\n"
                 "uniform float offset;\n"
                 "void main() { result = VALUE + offset; }\n");
    ShaderLibrary library(folder.root());
    Program& two = library.compute("value.comp", {{"VALUE", "2.0"}});
    Program& three = library.compute("value.comp", {{"VALUE", "3.0"}});
    EXPECT_NE(&two, &three);
    EXPECT_EQ(&two, &library.compute("value.comp", {{"VALUE", "2.0"}}));
    const Buffer result(sizeof(float));
    result.bind(GL_SHADER_STORAGE_BUFFER, 0);
    for (Program* program : {&two, &three}) {
        program->set("offset", 0.5F);
        program->set("not_there", 1.0F);  // no error
        program->use();
        glDispatchCompute(1, 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        float value = 0;
        result.read(std::span<float>(&value, 1));
        EXPECT_EQ(value, program == &two ? 2.5F : 3.5F);
    }
}

/// A compute shader that writes what it includes, and what it writes.
class ReloadedShaders : public Shaders {
protected:
    void SetUp() override {
        folder_.write("common/value.glsl", "const float value = 1.0;\n");
        folder_.write("value.comp",
                      "#version 450 core\n"
                      "#include \"common/value.glsl\"\n"
                      "layout(local_size_x = 1) in;\n"
                      "layout(std430, binding = 0) buffer Result { float result; };\n"
                      "void main() { result = value; }\n");
        library_.emplace(folder_.root());
        program_ = &library_->compute("value.comp");
    }

    float written() const {
        const Buffer result(sizeof(float));
        result.bind(GL_SHADER_STORAGE_BUFFER, 0);
        program_->use();
        glDispatchCompute(1, 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        float value = 0;
        result.read(std::span<float>(&value, 1));
        return value;
    }

    ShaderFolder folder_;
    std::optional<ShaderLibrary> library_;
    Program* program_ = nullptr;
};

TEST_F(ReloadedShaders, stay_while_nothing_is_written) {
    EXPECT_EQ(written(), 1.0F);
    const GLuint name = program_->name();
    folder_.write("value.comp.swp", "an editor's own file");
    const ShaderReload reload = library_->reload_changed();
    EXPECT_FALSE(reload.files_changed);
    EXPECT_TRUE(reload.reloaded.empty());
    EXPECT_EQ(program_->name(), name);
}

TEST_F(ReloadedShaders, are_new_in_their_place_when_an_include_is_written) {
    folder_.write("other.comp", "#version 450 core\nlayout(local_size_x = 1) in;\nvoid main() {}\n");
    const Program& other = library_->compute("other.comp");
    library_->reload_changed();
    const GLuint other_name = other.name();
    folder_.write("common/value.glsl", "const float value = 22.0;\n");
    const ShaderReload reload = library_->reload_changed();
    EXPECT_TRUE(reload.files_changed);
    EXPECT_THAT(reload.reloaded, testing::ElementsAre("value.comp"));
    EXPECT_TRUE(reload.errors.empty());
    EXPECT_EQ(program_, &library_->compute("value.comp"));
    EXPECT_EQ(written(), 22.0F);
    EXPECT_EQ(other.name(), other_name);
    EXPECT_FALSE(library_->reload_changed().files_changed);
}

TEST_F(ReloadedShaders, keep_the_last_good_program_until_the_error_is_mended) {
    folder_.write("common/value.glsl", "const float value = no_such_thing;\n");
    const ShaderReload broken = library_->reload_changed();
    EXPECT_TRUE(broken.reloaded.empty());
    ASSERT_EQ(broken.errors.size(), 1U);
    EXPECT_THAT(broken.errors.front(), testing::HasSubstr("common/value.glsl:1"));
    EXPECT_EQ(written(), 1.0F);
    // Told again whatever is written, until it is mended.
    folder_.write("elsewhere.glsl", "float unused;\n");
    EXPECT_EQ(library_->reload_changed().errors, broken.errors);
    folder_.write("common/value.glsl", "const float value = 3.0;\n");
    const ShaderReload mended = library_->reload_changed();
    EXPECT_TRUE(mended.errors.empty());
    EXPECT_THAT(mended.reloaded, testing::ElementsAre("value.comp"));
    EXPECT_EQ(written(), 3.0F);
}

TEST_F(ReloadedShaders, notice_an_include_that_comes_late) {
    folder_.write("value.comp",
                  "#version 450 core\n"
                  "#include \"common/later.glsl\"\n"
                  "layout(local_size_x = 1) in;\n"
                  "layout(std430, binding = 0) buffer Result { float result; };\n"
                  "void main() { result = later; }\n");
    EXPECT_EQ(library_->reload_changed().errors.size(), 1U);
    EXPECT_EQ(written(), 1.0F);
    folder_.write("common/later.glsl", "const float later = 4.0;\n");
    EXPECT_TRUE(library_->reload_changed().errors.empty());
    EXPECT_EQ(written(), 4.0F);
}

TEST_F(ReloadedShaders, may_vanish_and_come_back) {
    fs::remove(folder_.root() / "common/value.glsl");
    EXPECT_EQ(library_->reload_changed().errors.size(), 1U);
    EXPECT_EQ(written(), 1.0F);
    folder_.write("common/value.glsl", "const float value = 5.0;\n");
    EXPECT_TRUE(library_->reload_changed().errors.empty());
    EXPECT_EQ(written(), 5.0F);
}

TEST(ShaderRoot, is_found_and_can_be_chosen) {
    EXPECT_TRUE(fs::exists(shader_root() / "common/fullscreen.vert"));
    const ShaderFolder folder;
    setenv("MATCHLIGHT_SHADERS", folder.root().c_str(), 1);
    EXPECT_EQ(shader_root(), folder.root());
    setenv("MATCHLIGHT_SHADERS", "/nonexistent/shaders", 1);
    EXPECT_THROW(shader_root(), InputError);
    unsetenv("MATCHLIGHT_SHADERS");
}

TEST(CompilerLogs, of_each_driver_are_translated) {
    const std::vector<std::string> files = {"a.frag", "common/b.glsl"};
    EXPECT_EQ(with_file_names("1:12(5): error: no", files), "common/b.glsl:12(5): error: no");
    EXPECT_EQ(with_file_names("0(7) : error C1503: no", files), "a.frag:7 : error C1503: no");
    EXPECT_EQ(with_file_names("ERROR: 1:3: 'x' : no\nERROR: 0:4: y", files),
              "ERROR: common/b.glsl:3: 'x' : no; ERROR: a.frag:4: y");
    EXPECT_EQ(with_file_names("0:100012(5): error: no", files), "common/b.glsl:12(5): error: no");
    EXPECT_EQ(with_file_names("linking failed", files), "linking failed");
}

}  // namespace
}  // namespace matchlight
