// Where the sources and the command of this build are. main.cpp alone knows, so that the other files compile
// to the same code in every checkout.
#pragma once

#include <string>

namespace springstab::test {

std::string source_folder();
std::string command_path();

}  // namespace springstab::test
