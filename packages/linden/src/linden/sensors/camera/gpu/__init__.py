"""Pictures made on a GPU: rays, shading and film stay there, bytes come back."""
