#!/bin/sh
# A film through ffmpeg and a pipe gives the maps of the same frames as files. Usage: tests/pipe_video.sh HAARLINE
set -eu
haarline=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
# 300 frames of both views side by side, of which the right one is cut 6 px further right.
views='[0]split[a][b];[a]crop=320:240:0:0[l];[b]crop=320:240:6:0[r];[l][r]hstack'
ffmpeg -v error -f lavfi -i 'mandelbrot=size=334x240:rate=30:end_scale=0.2' -frames:v 300 -filter_complex "$views" \
  -c:v ffv1 -pix_fmt gray take.mkv
mkdir frames
ffmpeg -v error -i take.mkv -pix_fmt gray -start_number 0 frames/%06d.png
options='--num-disparities 32 --write disparity'
ffmpeg -v error -i take.mkv -f rawvideo -pix_fmt gray - |
  "$haarline" play - --raw 320x240 --wiring side-by-side $options -o pipe >/dev/null
"$haarline" play frames --layout side-by-side --first left $options -o files >/dev/null
count=0
for map in files/*.pfm; do
  cmp "$map" "pipe/${map#files/}"
  count=$((count + 1))
done
test "$count" -eq 300
echo "$count maps are the same through the pipe and from files"
