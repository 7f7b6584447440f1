// One small band, for counting the instructions of its painting: tools/count-arm64.
#include <cstdio>
#include <cstring>

#include "core/reslice/prepared_sweep.h"
#include "tests/support/speed_sweep.h"

int main(int argc, char** argv) {
  using namespace sonoband;
  if (argc != 4) return std::fprintf(stderr, "one_band PLANE nearest|linear TIMES\n"), 2;
  // The work of speed_sweep, a corner of it: frames as far apart, layers as many.
  test::SpeedSweepOptions options;
  options.frames = 60;
  options.width = options.height = 160;
  options.length_mm = 30;
  const test::TestSweep sweep = test::speed_sweep(options);
  PreparedSweep prepared(sweep.view());
  prepared.prepare();
  RenderSettings settings;
  settings.band = {14, 0.2};
  settings.interpolation =
      std::strcmp(argv[2], "linear") == 0 ? Interpolation::linear : Interpolation::nearest;
  for (auto& [name, plane] : test::speed_planes(64, 64)) {
    if (name != argv[1]) continue;
    plane.origin.v += Eigen::Vector3d(0, 16 - 48, 15 - 50);  // to the middle of the small sweep
    Serial serial;
    std::size_t covered = 0;
    for (int i = 0; i < std::atoi(argv[3]); ++i) {
      const BandImage image = render_planar(prepared, plane, settings, serial);
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) covered += image.coverage.view()(x, y);
    }
    std::printf("%zu\n", covered);
    return 0;
  }
  return std::fprintf(stderr, "one_band: no plane %s\n", argv[1]), 2;
}
