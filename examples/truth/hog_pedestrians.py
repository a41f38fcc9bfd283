"""Find pedestrians in the pictures of an export with the detector that OpenCV ships, and write results of COCO.

    pip install opencv-python-headless
    basu truth export runs/latest --format coco -o truth
    python examples/truth/hog_pedestrians.py truth detections.json
    basu truth evaluate truth --detections detections.json

The detector is Dalal and Triggs's histogram of oriented gradients with a linear classifier (CVPR 2005), trained on
photographs of standing people, 96 pixels high at least. So pictures are enlarged first.
"""

import json
import sys
from pathlib import Path

import cv2

ENLARGED = 2.0
PEDESTRIAN = "pedestrian"


def main(folder: Path, target: Path) -> None:
    """Detect in all pictures of an export."""
    detector = cv2.HOGDescriptor()
    detector.setSVMDetector(cv2.HOGDescriptor_getDefaultPeopleDetector())
    document = json.loads((folder / "annotations.json").read_text())
    category = next(each["id"] for each in document["categories"] if each["name"] == PEDESTRIAN)
    results = []
    for image in document["images"]:
        picture = cv2.resize(cv2.imread(str(folder / image["file_name"])), None, fx=ENLARGED, fy=ENLARGED)
        boxes, scores = detector.detectMultiScale(picture, winStride=(8, 8), scale=1.05)
        for (left, top, width, height), score in zip(boxes, scores, strict=True):
            # the detector's window has a margin of a sixth of its width and of an eighth of its height on each side
            inner = [left + width / 6.0, top + height / 8.0, width * 2.0 / 3.0, height * 3.0 / 4.0]
            results.append(
                {
                    "image_id": image["id"],
                    "category_id": category,
                    "bbox": [float(value / ENLARGED) for value in inner],
                    "score": float(score),
                }
            )
    target.write_text(json.dumps(results))
    print(f"{len(results)} detections in {len(document['images'])} pictures")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
