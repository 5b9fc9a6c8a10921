"""What tests of files share is imported from this folder, from those below it too."""
