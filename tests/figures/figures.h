// The paper's figures, made anew from the simulated scenes and the flow; tools/figures runs them.
#pragma once

#include <string>

namespace sonoband::figures {

// Each writes its pictures into `folder`, which exists.
void figure_3(const std::string& folder);         // viewpoints round a thick band
void figures_4_and_5(const std::string& folder);  // thin beside maximum, thin beside mean
void figure_6(const std::string& folder);         // Doppler: artery, bifurcation, vein
void figure_8(const std::string& folder);
void figure_9(const std::string& folder);
void figure_10(const std::string& folder);
void figures_11_to_13(const std::string& folder);  // planar and unrolled, thin and thick, and a raw B-scan

}  // namespace sonoband::figures
