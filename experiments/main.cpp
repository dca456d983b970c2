#include "experiments/experiments.h"

int main(int argc, char** argv) { return springstab::run_command(argc, argv); }
