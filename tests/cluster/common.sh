# Sourced by the tests of engines, with the program and a folder as arguments.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
"$root/scripts/setup" "$root/scripts/packages-cluster.txt"
fettle=$1
rm -rf "$2"
mkdir -p "$2"
cd "$2"
failed() {
  echo "$0: $*" >&2
  exit 1
}
same() { cmp "$1" "$2" || failed "$1 is not the file of one run"; }
"$fettle" synth scan.tif --size 512x900 --seed 22 --quiet
filter=(filter scan.tif out.tif --filter tgv)
"$fettle" filter scan.tif whole.tif --filter tgv --compute cpu --quiet
plan() { "$fettle" plan "${filter[@]}" --shards "$1" --quiet "${@:2}"; }
