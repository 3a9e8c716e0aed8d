"""The drawings of the documents, made from the kernel: `python -m docs.figures`."""
