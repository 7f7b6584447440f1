// Stradwin / StradView (.sw + .sxi) and Stradx (.sx + .sxi) recordings, in and out. No real file was at hand:
// reader and writer follow the published descriptions, and are tested against files made after those.
// Sources: http://mi.eng.cam.ac.uk/~rwp/stradx7.3/stradx_files.html (Stradx: IM has a size field, time in
// ns); http://mi.eng.cam.ac.uk/~gmt11/stradview/stradwin_files.html (Stradwin: no size field, resources
// RES_*).
#pragma once

#include <filesystem>
#include <istream>
#include <string>

#include "app/exchange/progress.h"
#include "app/exchange/sequence.h"

namespace sonoband::exchange {

// By its extension, .sx or .sw: the formats have no first line of their own.
bool is_strad(const std::filesystem::path& path);

// Positions in cm, angles in degrees, R = Rz(azimuth) Ry(elevation) Rx(roll); room = ISOCENTRE * POSITION *
// CALIBRATION * (x xscale, y yscale, 0) with pixel centres at halves. Gives ProbeToTracker of each frame (mm,
// ISOCENTRE included) and ImageToProbe of the header. Colours come in Stradx's byte code and leave as keys of
// core/image/doppler.h (field SonobandPixels = doppler). `pixels` is the .sxi; its length must fit the header
// exactly. Throws BadInput naming file and line.
ReadSequence read_strad(std::istream& header, const std::string& file, std::istream& pixels,
                        const std::string& pixel_file, const SequenceLimits& limits);
ReadSequence read_strad(const std::filesystem::path& path);

// Writes PATH (.sx or .sw) and the .sxi beside. Frames without a usable ImageTo<world>Transform have no place
// in these formats: they are left out, and their number is returned. Throws BadInput where a calibration
// cannot be said: the formats know right angles and one pair of scales only.
int write_strad(const TrackedSequence& sequence, const std::string& world, bool doppler,
                const std::filesystem::path& path, const Progress& progress = {});

}  // namespace sonoband::exchange
