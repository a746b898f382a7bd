// VTK's XML: the points of polygonal data (.vtp) and unstructured grids (.vtu) with their point data, one piece.
#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/sphere_readers.h"
#include "scene/text_fields.h"
#include "scene/vtk_xml_bytes.h"

namespace matchlight {
namespace {

struct XmlTag {
    std::string name;  // "/Points" where it ends
    std::map<std::string, std::string, std::less<>> attributes;
    bool is_empty = false;  // <DataArray .../>

    std::string_view at(std::string_view attribute) const {
        const auto found = attributes.find(attribute);
        return found == attributes.end() ? std::string_view() : std::string_view(found->second);
    }
};

struct XmlArray {
    NumberType type = NumberType::float32;
    std::uint64_t components = 1;
    bool is_place = false;
    std::vector<SphereValues> wanted;  // of each component
    std::uint64_t offset = 0;          // of what is appended
};

class VtpReader {
public:
    VtpReader(ChunkedFile& file, SphereBuilder& builder) : file_(file), builder_(builder) {}

    void read() {
        while (const auto tag = next_tag()) {
            if (tag->name == "VTKFile") read_kind(*tag);
            if (tag->name == "Piece") begin_piece(*tag);
            if (tag->name == "Points" || tag->name == "PointData") section_ = tag->is_empty ? "" : tag->name;
            if (tag->name == "/Points" || tag->name == "/PointData") section_.clear();
            if (tag->name == "DataArray" && !section_.empty()) read_array(*tag);
            if (tag->name == "AppendedData") return read_appended(*tag);
        }
        if (!is_vtk_) fail("it is no VTK file");
        if (!appended_.empty()) fail("its appended data are missing");
        if (!has_place_ && points_ > 0) fail("it has no Points");
    }

private:
    [[noreturn]] void fail(const std::string& cause, const std::string& cure = {}) const {
        throw InputError(file_.path(), cause, cure);
    }
    std::optional<XmlTag> next_tag();
    void read_kind(const XmlTag& tag);
    void begin_piece(const XmlTag& tag);
    void read_array(const XmlTag& tag);
    void read_appended(const XmlTag& tag);
    void read_text(const XmlArray& array);
    void read_bytes(const XmlArray& array, VtkXmlBytes& bytes);
    void take(const XmlArray& array, std::uint64_t index, double number);

    ChunkedFile& file_;
    SphereBuilder& builder_;
    VtkXmlCoding coding_;
    std::string section_;
    bool is_vtk_ = false, has_piece_ = false, has_place_ = false;
    std::uint64_t points_ = 0;
    std::array<double, 3> centre_{};
    std::vector<XmlArray> appended_;
};

std::optional<XmlTag> VtpReader::next_tag() {
    constexpr std::size_t longest_tag = 1u << 16;
    while (file_.peek() && *file_.peek() != '<') file_.bytes(1, "a tag");
    if (!file_.peek()) return std::nullopt;
    file_.bytes(1, "a tag");
    std::string text;
    for (char next = 0; (next = file_.bytes(1, "a tag").front()) != '>';) {
        text += next;
        if (text.size() > longest_tag) fail("a tag has no end");
    }
    XmlTag tag;
    tag.is_empty = text.ends_with('/');
    if (tag.is_empty) text.pop_back();
    std::string_view rest = text;
    tag.name = next_word(rest);
    while (true) {
        const std::size_t equals = rest.find('=');
        if (equals == std::string_view::npos) return tag;
        const std::size_t open = rest.find_first_of("\"'", equals);
        const std::size_t close = open == std::string_view::npos ? open : rest.find(rest[open], open + 1);
        if (close == std::string_view::npos) return tag;
        tag.attributes.emplace(trimmed(rest.substr(0, equals)), rest.substr(open + 1, close - open - 1));
        rest.remove_prefix(close + 1);
    }
}

void VtpReader::read_kind(const XmlTag& tag) {
    is_vtk_ = true;
    const std::string_view kind = tag.at("type"), packed = tag.at("compressor");
    if (kind != "PolyData" && kind != "UnstructuredGrid") {
        fail(fmt::format("a data set of the kind '{}' has no spheres", kind.substr(0, 40)),
             "use PolyData or UnstructuredGrid");
    }
    if (!packed.empty() && packed != "vtkZLibDataCompressor") {
        fail(fmt::format("data packed by '{}' are not read", packed.substr(0, 40)));
    }
    coding_.is_packed = !packed.empty();
    coding_.is_big_endian = tag.at("byte_order") == "BigEndian";
    if (tag.at("header_type") == "UInt64") coding_.header = NumberType::uint64;
}

void VtpReader::begin_piece(const XmlTag& tag) {
    const auto points = count_in(tag.at("NumberOfPoints"));
    if (!points) fail("a Piece has no NumberOfPoints");
    if (has_piece_) fail("it has more than one Piece");
    if (!is_vtk_) fail("it is no VTK file");
    has_piece_ = true;
    points_ = *points;
    file_.check_count(points_, coding_.is_packed ? 1 : 6, "points");
    builder_.begin_columns(points_);
}

void VtpReader::take(const XmlArray& array, std::uint64_t index, double number) {
    const std::uint64_t component = index % array.components, point = index / array.components;
    if (!array.is_place) {
        if (array.wanted[component].any()) builder_.set(point, array.wanted[component], number);
        return;
    }
    centre_[component] = number;
    if (component == 2) builder_.set_centre(point, centre_);
}

void VtpReader::read_array(const XmlTag& tag) {
    static const std::map<std::string_view, NumberType> types = {
        {"Int8", NumberType::int8},       {"UInt8", NumberType::uint8},   {"Int16", NumberType::int16},
        {"UInt16", NumberType::uint16},   {"Int32", NumberType::int32},   {"UInt32", NumberType::uint32},
        {"Int64", NumberType::int64},     {"UInt64", NumberType::uint64}, {"Float32", NumberType::float32},
        {"Float64", NumberType::float64},
    };
    const std::string name(tag.at("Name"));
    const auto type = types.find(tag.at("type"));
    if (type == types.end()) fail(fmt::format("numbers of '{}' are of a type that is not read", name));
    XmlArray array;
    array.type = type->second;
    array.is_place = section_ == "Points";
    array.components = count_in(tag.at("NumberOfComponents")).value_or(1);
    constexpr std::uint64_t most_components = 1000;
    if (array.components < 1 || array.components > most_components || (array.is_place && array.components != 3)) {
        fail(fmt::format("'{}' has a wrong number of components", name));
    }
    has_place_ = has_place_ || array.is_place;
    const ColumnKind kind = array.type == NumberType::uint8 ? ColumnKind::byte : ColumnKind::number;
    for (std::uint64_t c = 0; c < array.components && !array.is_place; ++c) {
        array.wanted.push_back(builder_.claim(array.components == 1 ? name : fmt::format("{}_{}", name, c), kind));
    }
    const bool is_wanted =
        array.is_place || std::ranges::any_of(array.wanted, [](const SphereValues& values) { return values.any(); });
    if (!is_wanted) return;
    if (tag.at("format") == "appended") {
        array.offset = count_in(tag.at("offset")).value_or(0);
        appended_.push_back(std::move(array));
    } else if (tag.at("format") == "binary") {
        VtkXmlBytes bytes(file_, coding_, true);
        read_bytes(array, bytes);
    } else {
        read_text(array);
    }
}

void VtpReader::read_text(const XmlArray& array) {
    std::string word;
    for (std::uint64_t i = 0; i < points_ * array.components;) {
        const auto next = file_.peek();
        if (!next || *next == '<') {
            if (word.empty()) fail("an array is shorter than its points are many");
        } else {
            file_.bytes(1, "an array");
            if (!is_blank(*next)) {
                word += *next;
                continue;
            }
        }
        if (word.empty()) continue;
        const auto number = number_in(word);
        if (!number) fail(fmt::format("'{}' is no number", word.substr(0, 40)));
        take(array, i++, *number);
        word.clear();
    }
}

void VtpReader::read_bytes(const XmlArray& array, VtkXmlBytes& bytes) {
    const std::size_t size = bytes_of(array.type);
    for (std::uint64_t i = 0; i < points_ * array.components; ++i) {
        take(array, i, number_at(bytes.bytes(size).data(), array.type, coding_.is_big_endian));
    }
}

void VtpReader::read_appended(const XmlTag& tag) {
    const bool is_base64 = tag.at("encoding") != "raw";
    while (file_.bytes(1, "its appended data").front() != '_') {
    }
    std::sort(appended_.begin(), appended_.end(),
              [](const XmlArray& a, const XmlArray& b) { return a.offset < b.offset; });
    std::uint64_t at = 0;
    for (const XmlArray& array : appended_) {
        if (array.offset < at) fail("its appended arrays overlap");
        file_.skip(array.offset - at, "its appended data");
        VtkXmlBytes bytes(file_, coding_, is_base64);
        if (points_ > 0) read_bytes(array, bytes);
        at = array.offset + bytes.characters();
    }
    appended_.clear();
    if (!has_place_ && points_ > 0) fail("it has no Points");
}

}  // namespace

void read_vtp_spheres(ChunkedFile& file, SphereBuilder& builder) {
    VtpReader(file, builder).read();
}

}  // namespace matchlight
