#!/bin/sh
# install.sh BUILD PREFIX CONFIG: installs a build that is there, into an empty prefix. The program runs there.
set -eu
unset DESTDIR
rm -rf "$2"
"$CMAKE" --install "$1" --prefix "$2" --config "$3"
if [ -e "$1/meniscus" ]; then
    "$2/bin/meniscus" --version
fi
