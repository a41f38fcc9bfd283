"""Contacts of bodies: pairs that are near, overlap of boxes, impulses between them."""
