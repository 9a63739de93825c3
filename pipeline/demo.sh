#!/usr/bin/env bash
# Installs what is missing, builds, and renders the first scene to look at. Safe to repeat.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
build release
build/release/pipeline/deforma run assets/scenes/cylinder_in_cylinder.toml --output out/cylinder_in_cylinder --overwrite
echo "The video is $PWD/out/cylinder_in_cylinder/video.mp4"
