"""A helper, imported as `stored`."""


def files(folder):
    """The bytes of each file of a folder, by its path there."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}
