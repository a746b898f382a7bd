// PDB, mmCIF, GRO, PLY, VTK and bgeo: small files of each, and files that are cut short or lie.
#include <bit>
#include <cstdint>
#include <initializer_list>

#include "sphere_test.h"

namespace matchlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

std::string big_endian(std::initializer_list<float> values) {
    std::string bytes;
    for (const float value : values) {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(bits >> shift & 255);
    }
    return bytes;
}
std::string little_endian(std::initializer_list<float> values) {
    std::string bytes;
    for (const float value : values) {
        const std::string one = big_endian({value});
        bytes.append(one.rbegin(), one.rend());
    }
    return bytes;
}

using SphereFormats = SphereFile;

const std::string pdb =
    "HEADER    A TEST\n"
    "MODEL        1\n"
    "ATOM      1  CA  ALA A   1      11.104   6.134  -6.504  1.00  9.50           C\n"
    "HETATM    2 CA    CA A   2       1.000   2.000   3.000  0.50  2.00\n"
    "ATOM      3 HG11 VAL A   3       4.000   5.000   6.000\n"
    "ENDMDL\n"
    "MODEL        2\n"
    "ATOM      1  N   ALA A   1       7.000   8.000   9.000  1.00  9.50           N\n"
    "ENDMDL\nEND\n";

TEST_F(SphereFormats, PdbNamesElementsByColumn) {
    EXPECT_THAT(load("a.pdb", pdb).spheres,
                ElementsAre(sphere_at(11.104F, 6.134F, -6.504F, 1.7F), sphere_at(1, 2, 3, 2.62F),  // carbon, calcium
                            sphere_at(4, 5, 6, 1.2F)));                                            // hydrogen
    EXPECT_THAT(load("a.pdb", pdb, with([](SphereSettings& s) { s.frame = 1; })).spheres,
                ElementsAre(sphere_at(7, 8, 9, 1.55F)));
    EXPECT_THAT(error_of("a.pdb", pdb, with([](SphereSettings& s) { s.frame = 2; })), HasSubstr("2 models"));
    EXPECT_THAT(load("a.pdb", pdb, with([](SphereSettings& s) {
                         s.radius_column = "b_factor";
                         s.frame = 1;
                     }))
                    .spheres,
                ElementsAre(sphere_at(7, 8, 9, 9.5F)));
    EXPECT_TRUE(warnings_.empty());
    EXPECT_THAT(error_of("a.pdb", "ATOM      1  CA  ALA A   1      11.104   x\n"), HasSubstr("a.pdb:1: 'x"));
    EXPECT_THAT(load("b.pdb", "HEADER\n").spheres, SizeIs(0));
}

const std::string mmcif =
    "data_1ABC\n_entry.id '1 ABC'\n_struct.title\n;A long\n_atom_site.title\n;\nloop_\n_atom_site.group_PDB\n"
    "_atom_site.type_symbol\n_atom_site.label_atom_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
    "_atom_site.B_iso_or_equiv\n_atom_site.pdbx_PDB_model_num\n"
    "ATOM O \"O5'\" 1.5 2.5 3.5 20 1\nHETATM ZN 'a b' 4 5 6 40\n1\nATOM C C ? 0 0 1 1\nATOM N N 7 8 9 1 "
    "2\n#\nloop_\n_x.y\n1\n";

TEST_F(SphereFormats, MmcifReadsTheLoopOfSites) {
    const SphereSet set = load("a.cif", mmcif, with([](SphereSettings& s) {
                                   s.color_column = "B_iso_or_equiv";
                                   s.color_map = 7;
                               }));
    EXPECT_THAT(set.spheres, ElementsAre(sphere_at(1.5F, 2.5F, 3.5F, 1.52F), sphere_at(4, 5, 6, 1.39F)));
    EXPECT_EQ(set.colors[1][0], 255);
    EXPECT_THAT(warning(), HasSubstr("1 spheres whose place is not finite"));
    EXPECT_THAT(load("a.cif", mmcif, with([](SphereSettings& s) { s.frame = 1; })).spheres,
                ElementsAre(sphere_at(7, 8, 9, 1.55F)));
    EXPECT_THAT(error_of("a.cif", mmcif.substr(0, mmcif.find("ATOM N")) + "ATOM C"), HasSubstr("ends inside an atom"));
    EXPECT_THAT(error_of("a.cif", "data_x\n_a.b 1\n"), HasSubstr("no _atom_site loop"));
    EXPECT_THAT(error_of("a.cif", "data_x\nloop_\n_atom_site.id\n1\n"), HasSubstr("Cartn_x"));
}

const std::string gro =
    "Two frames, t= 0.0\n    3\n"
    "    1WATER  OW1    1   0.126   1.624   1.679  0.1227 -0.0580  0.0434\n"
    "    1WATER  HW2    2   0.190   1.661   1.747  0.8085  0.3191 -0.7791\n"
    "    2CA      CA    3   0.226   1.624   1.679\n"
    "   1.82060   1.82060   1.82060\n"
    "t= 1.0\n    1\n    1ALA     CA    1   1.000   2.000   3.000\n   1 1 1\n";

TEST_F(SphereFormats, GroIsInNanometres) {
    EXPECT_THAT(load("a.gro", gro).spheres,
                ElementsAre(sphere_at(0.126F, 1.624F, 1.679F, 0.152F), sphere_at(0.19F, 1.661F, 1.747F, 0.12F),
                            sphere_at(0.226F, 1.624F, 1.679F, 0.262F)));
    EXPECT_THAT(load("a.gro", gro, with([](SphereSettings& s) { s.frame = 1; })).spheres,
                ElementsAre(sphere_at(1, 2, 3, 0.17F)));
    const SphereSet fast = load("a.gro", gro, with([](SphereSettings& s) {
                                    s.color_column = "vx";
                                    s.color_map = 7;
                                    s.color_range = std::array{0.0, 0.8085};
                                }));
    EXPECT_EQ(fast.colors[1][0], 255);
    EXPECT_THAT(error_of("a.gro", "t\n999999999\n" + gro.substr(27)), HasSubstr("promises 999999999 atoms"));
    EXPECT_THAT(error_of("a.gro", gro.substr(0, 100)), HasSubstr("a.gro"));
    EXPECT_THAT(error_of("a.gro", "t\nthree\n"), HasSubstr("a.gro:2: 'three' is no number of atoms"));
}

const std::string ply_header =
    "format binary_little_endian 1.0\nelement camera 1\nproperty double t\nelement vertex 2\nproperty float x\n"
    "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    "property uchar alpha\nproperty float radius\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST_F(SphereFormats, PlyInEitherOrderAndAscii) {
    const std::string little = "ply\n" + ply_header + std::string(8, '\0') + little_endian({1, 2, 3}) + "\xff\x80" +
                               std::string(1, '\0') + "\xff" + little_endian({0.5F}) + little_endian({4, 5, 6}) +
                               std::string("\x01\x01\x01\x33", 4) + little_endian({0.25F}) + "faces";
    std::string big_header = ply_header;
    big_header.replace(big_header.find("little"), 6, "big");
    const std::string big = "ply\n" + big_header + std::string(8, '\0') + big_endian({1, 2, 3}) + "\xff\x80" +
                            std::string(1, '\0') + "\xff" + big_endian({0.5F}) + big_endian({4, 5, 6}) +
                            std::string("\x01\x01\x01\x33", 4) + big_endian({0.25F});
    std::string text_header = ply_header;
    text_header.replace(text_header.find("binary_little_endian"), 20, "ascii");
    const std::string text = "ply\n" + text_header + "0\n1 2 3 255 128 0 255 0.5\n4 5 6 1 1 1 51 0.25\n3 0 1 0\n";
    for (const std::string& bytes : {little, big, text}) {
        const SphereSet set = load("a.ply", bytes);
        EXPECT_THAT(set.spheres, ElementsAre(sphere_at(1, 2, 3, 0.5F), sphere_at(4, 5, 6, 0.25F)));
        EXPECT_EQ(set.colors[0], (std::array<std::uint8_t, 4>{255, 128, 0, 255}));
        EXPECT_EQ(set.colors[1], (std::array<std::uint8_t, 4>{1, 1, 1, 255}));
        EXPECT_THAT(set.opacities, ElementsAre(1, 0.2F));
    }
    EXPECT_THAT(error_of("a.ply", big.substr(0, big.size() - 1)), HasSubstr("ends inside its vertices"));
    std::string lie = ply_header;
    lie.replace(lie.find("vertex 2"), 8, "vertex 1000000000");
    EXPECT_THAT(error_of("a.ply", "ply\n" + lie), HasSubstr("a.ply"));
    EXPECT_THAT(error_of("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
                HasSubstr("no x, y and z"));
    EXPECT_THAT(error_of("a.ply", "plyx\n"), HasSubstr("no PLY file"));
    EXPECT_THAT(error_of("a.ply", "ply\nformat ascii 1.0\n"), HasSubstr("ends before the end of its header"));
}

TEST_F(SphereFormats, VtkInAsciiAndBinary) {
    const std::string text =
        "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n1 2 3\n4 5\n6\n"
        "VERTICES 2 4\n1 0\n1 1\nCELL_DATA 2\nSCALARS m int\nLOOKUP_TABLE default\n7 8\n"
        "POINT_DATA 2\nSCALARS size float 1\nLOOKUP_TABLE default\n0.5\n0.25\n"
        "FIELD FieldData 1\nvelocity 3 2 double\n0 0 1 0 0 2\n";
    const auto settings = with([](SphereSettings& s) {
        s.radius_column = "size";
        s.color_column = "velocity_2";
        s.color_map = 7;
    });
    const std::string binary =
        "# vtk DataFile Version 5.1\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 2 float\n" +
        big_endian({1, 2, 3, 4, 5, 6}) + "\nMETADATA\nINFORMATION 0\n\nCELLS 1 2\nOFFSETS vtktypeint64\n" +
        std::string(8, '\0') + "\nCONNECTIVITY vtktypeint64\n" + std::string(16, '\0') + "\nCELL_TYPES 1\n" +
        std::string(4, '\0') + "\nPOINT_DATA 2\nFIELD FieldData 2\nsize 1 2 float\n" + big_endian({0.5F, 0.25F}) +
        "\nvelocity 3 2 float\n" + big_endian({0, 0, 1, 0, 0, 2}) + "\n";
    for (const std::string& bytes : {text, binary}) {
        const SphereSet set = load("a.vtk", bytes, settings);
        EXPECT_THAT(set.spheres, ElementsAre(sphere_at(1, 2, 3, 0.5F), sphere_at(4, 5, 6, 0.25F)));
        EXPECT_EQ(set.colors[0][1], 0);
        EXPECT_EQ(set.colors[1][1], 255);
        EXPECT_THAT(set.columns, testing::Contains("velocity_1"));
    }
    EXPECT_THAT(error_of("a.vtk", text), HasSubstr("does not say how large"));
    EXPECT_THAT(error_of("a.vtk", text, with([](SphereSettings& s) { s.radius_column = "sise"; })),
                HasSubstr("no column 'sise' for radius_column; did you mean 'size'?"));
    EXPECT_THAT(error_of("a.vtk", binary.substr(0, binary.size() - 9), settings), HasSubstr("a.vtk"));
    std::string negative = text;
    negative.replace(negative.find("0.25"), 4, "-0.2");
    EXPECT_THAT(error_of("a.vtk", negative, settings), HasSubstr("sphere 1 (counted from 0) has the radius -0.2"));
    std::string lie = text;
    lie.replace(lie.find("POINTS 2"), 8, "POINTS 1000000000");
    EXPECT_THAT(error_of("a.vtk", lie, settings), HasSubstr("1000000000 points"));
    std::string nowhere = text;
    nowhere.replace(nowhere.find("1 2 3"), 5, "1 nan 3");
    EXPECT_THAT(load("a.vtk", nowhere, settings).spheres, ElementsAre(sphere_at(4, 5, 6, 0.25F)));
    EXPECT_THAT(error_of("a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n"),
                HasSubstr("'STRUCTURED_POINTS' has no spheres"));
}

/// A VTP of two points with radii; each array is given as its attributes and contents.
std::string vtp(const std::string& attributes, const std::array<std::string, 2>& arrays, const std::string& end = {}) {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"" + attributes +
           "><PolyData><Piece NumberOfPoints='2' NumberOfVerts='0'>\n<PointData Scalars=\"radius\">"
           "<DataArray type=\"Float64\" Name=\"radius\" " +
           arrays[1] +
           "</DataArray></PointData><CellData></CellData><Points><DataArray type=\"Float32\" "
           "NumberOfComponents=\"3\" " +
           arrays[0] + "</DataArray></Points></Piece></PolyData>" + end + "</VTKFile>\n";
}

TEST_F(SphereFormats, VtpInEveryCoding) {
    const std::string places = "GAAAAAAAgD8AAABAAABAQAAAgEAAAKBAAADAQA==", radii = "EAAAAAAAAAAAAOA/AAAAAAAA0D8=";
    const std::string raw_places = little_endian({std::bit_cast<float>(24), 1, 2, 3, 4, 5, 6});
    const std::string raw_radii = little_endian({std::bit_cast<float>(16), 0, 1.75F, 0, 1.625F});  // doubles 0.5, 0.25
    const std::string zlib = " compressor=\"vtkZLibDataCompressor\"";
    const auto appended = [](int offset) { return "format=\"appended\" offset=\"" + std::to_string(offset) + "\">"; };
    const std::string text = vtp("", {"format=\"ascii\">1 2 3\n4 5 6", "format=\"ascii\">\n0.5 0.25 "});
    const std::string base64 = vtp("", {"format=\"binary\">\n " + places, "format=\"binary\">" + radii});
    // Packed by Python's zlib: places in two blocks of 16 and 8 bytes, radii in one.
    const std::string packed =
        vtp(zlib, {"format=\"binary\">AgAAABAAAAAIAAAAFQAAABAAAAA=eJxjYGiwZ2BgcAAiIG5wAAAQgwJAeJxjYFjgwMBwwAEABsgB4Q==",
                   "format=\"binary\">AQAAABAAAAAAAAAAEgAAAA==eJxjYACBB/ZgiuGCPQAM5gIv"});
    const std::string raw = vtp("", {appended(20), appended(0)},
                                "<AppendedData encoding=\"raw\">\n _" + raw_radii + raw_places + "</AppendedData>");
    const std::string appended_base64 = vtp("", {appended(0), appended(40)},
                                            "<AppendedData encoding=\"base64\">_" + places + radii + "</AppendedData>");
    for (const std::string& bytes : {text, base64, packed, raw, appended_base64}) {
        EXPECT_THAT(load("a.vtp", bytes).spheres, ElementsAre(sphere_at(1, 2, 3, 0.5F), sphere_at(4, 5, 6, 0.25F)))
            << bytes;
    }
    EXPECT_THAT(error_of("a.vtp", base64.substr(0, base64.find("AADAQA"))), HasSubstr("ends inside an array"));
    EXPECT_THAT(error_of("a.vtp", vtp("", {"format=\"ascii\">1 2 3 4", "format=\"ascii\">1 1"})),
                HasSubstr("shorter than its points are many"));
    EXPECT_THAT(error_of("a.vtp", vtp("", {appended(0), appended(0)}, "<AppendedData encoding=\"raw\">_ab")),
                HasSubstr("ends inside an array"));
    EXPECT_THAT(error_of("a.vtp", vtp(" compressor=\"vtkLZ4DataCompressor\"", {">", ">"})), HasSubstr("vtkLZ4"));
    std::string lie = text;
    lie.replace(lie.find("Points='2'"), 10, "Points='1000000000'");
    EXPECT_THAT(error_of("a.vtp", lie), HasSubstr("1000000000 points"));
    EXPECT_THAT(error_of("a.vtp", "<html></html>"), HasSubstr("no VTK file"));
}

std::string whole(std::uint32_t value) {
    return big_endian({std::bit_cast<float>(value)});
}

TEST_F(SphereFormats, BgeoWithAttributes) {
    const std::string header =
        "BgeoV" + whole(5) + whole(2) + whole(0) + whole(0) + whole(0) + whole(2) + whole(0) + whole(0) + whole(0);
    const std::string attributes = std::string("\0\6pscale\0\1", 10) + whole(0) + whole(0) +
                                   std::string("\0\2Cd\0\3", 6) + whole(0) + whole(0) + whole(0) + whole(0);
    const std::string points = big_endian({1, 2, 3, 1, 0.5F, 1, 0, 0, 4, 5, 6, 1, 0.25F, 0, 0, 1});
    const SphereSet set = load("a.bgeo", header + attributes + points + std::string("\0\xff", 2));
    EXPECT_THAT(set.spheres, ElementsAre(sphere_at(1, 2, 3, 0.5F), sphere_at(4, 5, 6, 0.25F)));
    EXPECT_EQ(set.colors[1], (std::array<std::uint8_t, 4>{0, 0, 255, 255}));
    EXPECT_THAT(error_of("a.bgeo", header + attributes + points.substr(0, 40)), HasSubstr("ends inside its points"));
    EXPECT_THAT(error_of("a.bgeo", header.substr(0, 12)), HasSubstr("ends inside its header"));
    EXPECT_THAT(error_of("a.bgeo", "{\"fileversion\":\"12\"}"), HasSubstr("classic kind"));
}

}  // namespace
}  // namespace matchlight
