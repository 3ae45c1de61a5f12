// DEMs and meshes as files have them: what is read, turned, filled and dropped, and what is refused.
#include "server/import/dem.h"
#include "server/import/fill_missing.h"
#include "server/import/mesh_file.h"
#include "tests/import_fixture.h"

namespace spoor {
namespace {

using ImportFiles = Import;

TEST_F(ImportFiles, DemIsFlippedFilledAndScaled) {
  DemRequest request;
  request.file = write(
      "small.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n1 2 3\n4 -9999 6\n");
  request.vertical_scale = 2;
  std::vector<std::string> notes;
  const Result<Dem> dem = readDem(request, notes);
  ASSERT_TRUE(dem) << dem.error();
  EXPECT_EQ(dem->column_count, 3);
  EXPECT_EQ(dem->row_count, 2);
  EXPECT_DOUBLE_EQ(dem->widthM(), 30);
  // South first; the gap takes the mean of 4, 6 and 2.
  EXPECT_EQ(dem->height_q, (std::vector<std::int32_t>{80000, 80000, 120000, 20000, 40000, 60000}));
  EXPECT_TRUE(anyContains(notes, "1 of 6 samples hold no data"));
}

TEST_F(ImportFiles, DemPartIsReadFromItsSouthWestCorner) {
  DemRequest request;
  request.file = write("part.asc",
                       "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 10\n"
                       "1 2 3 4\n5 6 7 8\n9 10 11 12\n13 14 15 16\n");
  request.west_m = 11;
  request.south_m = 10;
  request.size_x_m = 15;
  request.size_y_m = 20;
  std::vector<std::string> notes;
  const Result<Dem> dem = readDem(request, notes);
  ASSERT_TRUE(dem) << dem.error();
  EXPECT_EQ(dem->height_q, (std::vector<std::int32_t>{100000, 110000, 60000, 70000}));
  EXPECT_TRUE(anyContains(notes, "corner moved"));
}

TEST_F(ImportFiles, BadDemsAreErrors) {
  const std::string head = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
  struct Case {
    std::string content, part;
  };
  const Case cases[] = {
      {head + "NODATA_value 5\n5 5 5\n5 5 5\n", "no sample holds data"},
      {head + "1 2 3\n4 1e6 6\n", "1000000 m at column 1, row 1"},
      {head + "1 2 3\n4 -32768 6\n", "marks missing data"},
      {head + "1 2 3\n", "damaged or cut short"},
      {"ncols 1\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1\n2\n", "2 x 2 are the least"},
      {"ncols 60000\nnrows 60000\nxllcorner 0\nyllcorner 0\ncellsize 10\n1\n2\n", "more than a pack holds"},
      {"neither text nor picture", "not a raster"},
      {"", "not a raster"},
  };
  for (const Case& bad : cases) {
    DemRequest request;
    request.file = write("bad.asc", bad.content);
    std::vector<std::string> notes;
    const Result<Dem> dem = readDem(request, notes);
    ASSERT_FALSE(dem) << bad.part;
    EXPECT_TRUE(contains(dem.error(), "bad.asc")) << dem.error();
    EXPECT_TRUE(contains(dem.error(), bad.part)) << dem.error();
  }
}

TEST_F(ImportFiles, LongTextGridCutShortFailsAtOnce) {
  std::string grid = "ncols 4\nnrows 200\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
  for (int row = 0; row < 100; ++row) grid += "1 2 3 4\n";
  DemRequest request;
  request.file = write("cut.asc", grid);
  request.south_m = 100;
  request.size_x_m = request.size_y_m = 30;
  std::vector<std::string> notes;
  const Result<Dem> dem = readDem(request, notes);
  ASSERT_FALSE(dem);
  EXPECT_TRUE(contains(dem.error(), "row 100 cannot be read")) << dem.error();
}

TEST_F(ImportFiles, FillMissingClosesAGapFromItsRim) {
  std::vector<std::int32_t> height{0, 77, 77, 9, -3, 77, 77, 9};
  std::vector<std::uint8_t> missing{0, 1, 1, 0, 0, 1, 1, 0};
  fillMissing(height, missing, 4);
  EXPECT_EQ(height, (std::vector<std::int32_t>{0, 0, 9, 9, -3, -3, 9, 9}));
}

TEST_F(ImportFiles, TruncatedGeoTiffIsAClearError) {
  SPOOR_NEEDS_DATA(path, "dem/gz_dem_squared.tif");
  std::ifstream in(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  for (const std::size_t length : {std::size_t(100), std::size_t(1200), std::size_t(40000), bytes.size() - 1}) {
    DemRequest request;
    request.file = write("cut.tif", bytes.substr(0, length));
    std::vector<std::string> notes;
    EXPECT_FALSE(readDem(request, notes)) << length;
  }
}

TEST_F(ImportFiles, RealMeshesImport) {
  for (const char* name : {"meshes/hmmwv_tire_coarse_closed.obj", "meshes/hmmwv_chassis_col.obj", "meshes/spot.obj"}) {
    SPOOR_NEEDS_DATA(path, name);
    std::vector<std::string> notes;
    const Result<Mesh> mesh = readMesh({"mesh", path, 1, ""}, 500, notes);
    ASSERT_TRUE(mesh) << mesh.error();
    EXPECT_GT(mesh->triangles.size(), 100u);
  }
}

TEST_F(ImportFiles, MeshWithYUpIsTurned) {
  const std::string path = write("one.obj", "v 0 0 1\nv 2 0 1\nv 2 3 1\nf 1 2 3\n");
  std::vector<std::string> notes;
  const Result<Mesh> mesh = readMesh({"one", path, 1, "y"}, 500, notes);
  ASSERT_TRUE(mesh) << mesh.error();
  const MeshBox box = boxOf(*mesh);  // forward z, left x, up y
  EXPECT_EQ(box.low, (std::array<std::int32_t, 3>{10000, 0, 0}));
  EXPECT_EQ(box.high, (std::array<std::int32_t, 3>{10000, 20000, 30000}));
}

TEST_F(ImportFiles, GltfIsTurnedByItselfAndItsNodesApply) {
  // The triangle of MeshWithYUpIsTurned, moved by (0, 10, 0) in its node.
  const std::string path = write("one.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0,"translation":[0,10,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,1],"max":[2,3,1]}],
"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
                                             "AAAAAAAAAAAAAIA/AAAAQAAAAAAAAIA/AAAAQAAAQEAAAIA/\"}]}");
  std::vector<std::string> notes;
  const Result<Mesh> mesh = readMesh({"one", path, 1, ""}, 500, notes);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(boxOf(*mesh).low, (std::array<std::int32_t, 3>{10000, 0, 100000}));
  EXPECT_EQ(boxOf(*mesh).high, (std::array<std::int32_t, 3>{10000, 20000, 130000}));
}

TEST_F(ImportFiles, MeshDropsWhatHasNoAreaWithANote) {
  const std::string path = write("mixed.obj",
                                 "mtllib none.mtl\nusemtl none\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0.00001 0\nv 9 9 9\n"
                                 "f 1 2 3\nf 1 4 2\nl 1 5\n");
  std::vector<std::string> notes;
  const Result<Mesh> mesh = readMesh({"mixed", path, 1, ""}, 500, notes);
  ASSERT_TRUE(mesh) << mesh.error();
  EXPECT_EQ(mesh->triangles.size(), 1u);
  EXPECT_EQ(mesh->vertices.size(), 3u);  // the line's far end does not count
  EXPECT_TRUE(anyContains(notes, "without area"));
}

TEST_F(ImportFiles, OtherMeshFormatsReadTheSame) {
  const std::string obj = write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const std::string ply = write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 "
      "0 3\n");
  const std::string stl = write(
      "a.stl",
      "solid a\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
      "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
      "facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n"
      "facet normal -1 0 0\nouter loop\nvertex 0 1 0\nvertex 0 0 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid a\n");
  for (const std::string& path : {obj, ply, stl}) {
    std::vector<std::string> notes;
    const Result<Mesh> mesh = readMesh({"a", path, 1, ""}, 500, notes);
    ASSERT_TRUE(mesh) << mesh.error();
    EXPECT_EQ(mesh->vertices.size(), 4u) << path;
    EXPECT_EQ(mesh->triangles.size(), 4u) << path;
    EXPECT_EQ(mesh->edges.size(), 6u) << path;
  }
}

TEST_F(ImportFiles, BadMeshesAreErrors) {
  struct Case {
    std::string content, part;
  };
  const Case cases[] = {
      {"v 0 0 0\nv 1 0 0\nl 1 2\n", "bad.obj"},
      {"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "without triangles"},
      {"v 0 0 0\nv 1e9 0 0\nv 0 1 0\nf 1 2 3\n", "vertex"},
      {"v 0 0 0\nv 60 0 0\nv 0 1 0\nf 1 2 3\n", "from its origin"},
      {"v 0 0 0\nf 1 2 3\n", "bad.obj"},
      {"", "not a mesh"},
      {std::string("\0\xff\x7f junk", 8), "not a mesh"},
  };
  for (const Case& bad : cases) {
    std::vector<std::string> notes;
    const Result<Mesh> mesh = readMesh({"bad", write("bad.obj", bad.content), 1, ""}, 500, notes);
    ASSERT_FALSE(mesh) << bad.content;
    EXPECT_TRUE(contains(mesh.error(), bad.part)) << mesh.error();
    EXPECT_EQ(std::count(mesh.error().begin(), mesh.error().end(), '\n'), 0) << mesh.error();
  }
}

}  // namespace
}  // namespace spoor
