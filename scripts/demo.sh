#!/bin/sh
# Installs what is missing, builds, makes a sample splash and draws it.
set -eu
cd "$(dirname "$0")/.."
sh scripts/deps.sh
cmake -S . -B build -G Ninja >/dev/null
cmake --build build --target meniscus_program
mkdir -p out
build/meniscus sample crown --particles 300000 -o out/crown.npz
build/meniscus render out/crown.npz -o out/crown.png
echo "The picture is out/crown.png; now try: build/meniscus render YOUR_FILE -o picture.png"
